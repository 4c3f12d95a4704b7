#pragma once

#include "geometry/interrupt.h"
#include "geometry/little_endian.h"
#include "geometry/result.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace lorica {

/// Reads little-endian numbers from bytes one after the other. After the first failure every number is 0, and error()
/// says which byte was expected to hold what, or that the work was stopped. Internal: not installed.
class ByteReader {
 public:
  /// @param offset  where to start; messages count bytes from the start of `bytes`
  /// @param name    of the file, for messages
  explicit ByteReader(std::string_view bytes, std::size_t offset = 0, std::string name = "data");

  /// @param what  the number's meaning, for messages
  template <typename T>
  T take(const char* what = "a number") {
    static_assert(std::is_arithmetic_v<T>);
    if (!has(sizeof(T), what)) return T{};
    const T value = loadLittleEndian<T>(bytes_.data() + offset_);
    offset_ += sizeof(T);
    return value;
  }

  double takeFinite(const char* what);
  /// @return a number from `min` to `end` - 1
  std::int32_t takeIndex(const char* what, std::int64_t min, std::int64_t end);
  /// Length of a list. It must fit into the remaining bytes, so that no damaged length causes a large allocation.
  std::size_t takeCount(const char* what, std::size_t bytesEach);
  std::string takeText(std::size_t length);
  /// Moves past bytes that somebody else decoded from rest(). @param count  at most left()
  void skip(std::size_t count) { offset_ += count; }

  /// Only the first failure counts. @param at  byte of `bytes`
  void fail(std::size_t at, std::string_view message);

  [[nodiscard]] bool ok() const { return !error_; }
  [[nodiscard]] const Error& error() const { return *error_; }
  [[nodiscard]] std::size_t offset() const { return offset_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - offset_; }
  [[nodiscard]] std::string_view rest() const { return bytes_.substr(offset_); }

 private:
  [[nodiscard]] bool has(std::size_t size, const char* what);

  std::string_view bytes_;
  std::size_t offset_;
  std::string name_;
  std::optional<Error> error_;
  SparseInterrupt interrupt_;
};

}  // namespace lorica
