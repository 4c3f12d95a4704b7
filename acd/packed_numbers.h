#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

// Whole numbers in as few bytes as each needs, and without a branch for each to decode. Internal: not installed.
//
//   control bytes, one for every four numbers      the numbers themselves, 1 to 4 bytes each, little-endian
//   | 3 2 1 0 | 7 6 5 4 | ...                      | 0 | 1 | 2 | ...
//
// Two bits of a control byte, lowest first, are the number of bytes less 1. Bits without a number are 0.

/// Appends the numbers, packed.
void appendPacked(std::span<const std::uint32_t> values, std::string& bytes);

/// Unpacks values.size() numbers from the start of the bytes.
/// @return how many bytes that took; nothing when they end too soon or set bits that no number owns
[[nodiscard]] std::optional<std::size_t> unpack(std::string_view bytes, std::span<std::uint32_t> values);

/// Differences of either sign as small numbers: 0, -1, 1, -2, 2 ... become 0, 1, 2, 3, 4 ... Modulo 2^32, so that any
/// two numbers have a difference.
[[nodiscard]] constexpr std::uint32_t zigzag(std::uint32_t difference) {
  return (difference << 1) ^ (0 - (difference >> 31));
}
[[nodiscard]] constexpr std::uint32_t unzigzag(std::uint32_t value) {
  return (value >> 1) ^ (0 - (value & 1));
}

}  // namespace lorica
