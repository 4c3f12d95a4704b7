#include "geometry/byte_reader.h"

#include "geometry/errors.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace lorica {

ByteReader::ByteReader(std::string_view bytes, std::size_t offset, std::string name)
    : bytes_(bytes), offset_(offset), name_(std::move(name)) {}

double ByteReader::takeFinite(const char* what) {
  const auto value = take<double>(what);
  if (!std::isfinite(value)) fail(offset_ - 8, fmt::format("{} is {}, expected a finite number", what, value));
  return value;
}

std::int32_t ByteReader::takeIndex(const char* what, std::int64_t min, std::int64_t end) {
  const auto value = take<std::int32_t>(what);
  if (value < min || value >= end) {
    fail(offset_ - 4, fmt::format("{} is {}, expected {} to {}", what, value, min, end - 1));
  }
  return value;
}

std::size_t ByteReader::takeCount(const char* what, std::size_t bytesEach) {
  const auto count = take<std::uint32_t>(what);
  if (count > left() / bytesEach || count > std::numeric_limits<std::int32_t>::max()) {
    fail(offset_ - 4, fmt::format("{} is {}, which needs {} bytes or more; {} are left", what, count,
                                  std::uint64_t{count} * bytesEach, left()));
  }
  return error_ ? 0 : count;
}

std::string ByteReader::takeText(std::size_t length) {
  std::string text(bytes_.substr(offset_, length));
  offset_ += length;
  return text;
}

void ByteReader::fail(std::size_t at, std::string_view message) {
  if (!error_) error_ = badFormat("{}: byte {}: {}", name_, at, message);
}

bool ByteReader::has(std::size_t size, const char* what) {
  if (!error_ && interrupt_.stopped()) error_ = cancelled();
  if (error_) return false;
  if (left() < size) {
    fail(offset_, fmt::format("expected {} ({}), {} left", what, counted(std::int64_t(size), "byte"),
                              counted(std::int64_t(left()), "byte is", "bytes are")));
    return false;
  }
  return true;
}

}  // namespace lorica
