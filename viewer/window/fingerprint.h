#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

namespace lorica {

/// Tells whether values are the same as before, without keeping them: 64 bits of FNV-1a.
class Fingerprint {
 public:
  void add(std::int64_t number) {
    for (int shift = 0; shift < 64; shift += 8) addByte(static_cast<std::uint64_t>(number) >> shift);
  }
  void add(double number) { add(std::bit_cast<std::int64_t>(number)); }
  void add(std::string_view text) {
    for (const char c : text) addByte(c);
    add(static_cast<std::int64_t>(text.size()));
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  void addByte(std::uint64_t byte) { hash_ = (hash_ ^ (byte & 0xff)) * 0x100000001b3; }
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

}  // namespace lorica
