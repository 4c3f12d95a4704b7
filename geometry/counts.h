#pragma once

#include <iterator>

namespace lorica {

/// The number of elements as an int, which is what indices are in Lorica: no list here comes near 2^31 elements.
template <typename Container>
[[nodiscard]] constexpr int countOf(const Container& container) {
  return static_cast<int>(std::size(container));
}

}  // namespace lorica
