#pragma once

#include "capture/named_weight.h"

#include <span>
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

/// Appends the expressions of one pose: their number in two bytes; for each the length of its name in one byte, the
/// name, and the weight. Those beyond the budgets are left out.
void putExpressions(std::span<const NamedWeight> expressions, ByteWriter& bytes);

}  // namespace lorica
