#pragma once

/// Reads and writes binary numbers independently of the machine's byte order. Internal: not installed.

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace lorica {

/// Reads a number from bytes in the given order. The caller must have checked that sizeof(T) bytes are available.
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

/// Appends a number to a string as little-endian bytes.
template <typename T, typename String>
void appendLittleEndian(T value, String& bytes) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native != std::endian::little) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

}  // namespace lorica
