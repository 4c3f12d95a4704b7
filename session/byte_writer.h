#pragma once

#include <string>
#include <string_view>
#include <type_traits>

namespace lorica {

/// Appends numbers to a byte string.
class ByteWriter {
 public:
  template <typename Number>
  /// Appends a number as it is in memory.
  void put(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    const auto* bytes = reinterpret_cast<const char*>(&number);
    bytes_.append(bytes, sizeof(Number));
  }
  void put(std::string_view bytes) { bytes_ += bytes; }            ///< appends them
  void clear() { bytes_.clear(); }                                 ///< keeps the memory
  [[nodiscard]] std::string_view bytes() const { return bytes_; }  ///< all that was appended

 private:
  std::string bytes_;
};

}  // namespace lorica
