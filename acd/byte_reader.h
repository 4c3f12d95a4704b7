#pragma once

#include "geometry/little_endian.h"
#include "geometry/result.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// Takes numbers from the bytes of a file one after the other. After the first failure everything is 0, and error()
/// tells what was expected at which byte. Internal: not installed.
class ByteReader {
 public:
  /// @param offset  where to begin; sentences count bytes from the start of `bytes`
  ByteReader(std::string_view bytes, std::size_t offset, std::string fileName);

  template <typename T>
  T take(const char* what) {
    if (!has(sizeof(T), what)) return T{};
    const T value = loadLittleEndian<T>(bytes_.data() + offset_);
    offset_ += sizeof(T);
    return value;
  }

  double takeFinite(const char* what);
  std::int32_t takeIndex(const char* what, std::int64_t least, std::int64_t end);
  /// Length of a list, which must fit into what is left: nothing is allocated on the word of a damaged number.
  std::size_t takeCount(const char* what, std::size_t bytesEach);
  std::string takeText(std::size_t length);
  /// Fills `values` from packed numbers, see acd/packed_numbers.h.
  void takePacked(const char* what, std::span<std::uint32_t> values);

  void fail(std::size_t at, std::string_view message);

  [[nodiscard]] bool ok() const { return !error_; }
  [[nodiscard]] const Error& error() const { return *error_; }
  [[nodiscard]] std::size_t offset() const { return offset_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - offset_; }

 private:
  [[nodiscard]] bool has(std::size_t size, const char* what);

  std::string_view bytes_;
  std::size_t offset_;
  std::string fileName_;
  std::optional<Error> error_;
};

}  // namespace lorica
