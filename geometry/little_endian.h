#pragma once

/// Numbers in files, whatever the machine's byte order. Internal: not installed.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace lorica {

/// Reads a number from bytes in the order given; the caller has checked that sizeof(T) bytes are there.
template <typename T>
[[nodiscard]] T loadBytes(const char* bytes, std::endian order) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

template <typename T>
[[nodiscard]] T loadLittleEndian(const char* bytes) {
  return loadBytes<T>(bytes, std::endian::little);
}

/// Appends a number as little-endian bytes to a string.
template <typename T, typename String>
void appendLittleEndian(T value, String& bytes) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native != std::endian::little) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

}  // namespace lorica
