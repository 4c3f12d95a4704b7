#pragma once

#include <cstddef>
#include <iterator>
#include <type_traits>

namespace lorica {

/// The number of elements as an int, which is what indices are in Lorica: no list here comes near 2^31 elements.
template <typename Container>
[[nodiscard]] constexpr int countOf(const Container& container) {
  return static_cast<int>(std::size(container));
}

/// The index of a value in its enumeration.
template <typename Enum>
requires std::is_enum_v<Enum>
[[nodiscard]] constexpr std::size_t ordinalOf(Enum value) {
  return static_cast<std::size_t>(value);
}

}  // namespace lorica
