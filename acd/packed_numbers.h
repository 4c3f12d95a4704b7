#pragma once

#include "geometry/byte_reader.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

// Variable-length encoding of integers, decoded without a branch per number. Internal: not installed.
//
//   control bytes, one for every four numbers      the numbers, 1 to 4 bytes each, little-endian
//   | 3 2 1 0 | 7 6 5 4 | ...                      | 0 | 1 | 2 | ...
//
// Each two bits of a control byte, lowest first, are the number of bytes minus 1. Unused bits are 0.

/// Packs the numbers and appends them to `bytes`.
void appendPacked(std::span<const std::uint32_t> values, std::string& bytes);

/// Unpacks values.size() numbers from the start of the bytes.
/// @return the number of bytes read; nothing if the bytes are truncated or unused bits are set
[[nodiscard]] std::optional<std::size_t> unpack(std::string_view bytes, std::span<std::uint32_t> values);

/// Reads packed numbers; zeros after a failure. @param what  their meaning, for messages
void takePacked(ByteReader& reader, const char* what, std::span<std::uint32_t> values);

/// Maps small signed differences to small unsigned numbers: 0, -1, 1, -2, 2 ... become 0, 1, 2, 3, 4 ... Modulo 2^32,
/// so the difference of any two numbers can be encoded.
[[nodiscard]] constexpr std::uint32_t zigzag(std::uint32_t difference) {
  return (difference << 1) ^ (0 - (difference >> 31));
}
[[nodiscard]] constexpr std::uint32_t unzigzag(std::uint32_t value) {
  return (value >> 1) ^ (0 - (value & 1));
}

}  // namespace lorica
