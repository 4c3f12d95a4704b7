#include "skinning/import/uri.h"

#include "geometry/errors.h"

#include <cstdint>

namespace lorica {

namespace {

[[nodiscard]] int base64Value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

[[nodiscard]] int hexValue(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

}  // namespace

bool isDataUri(std::string_view uri) {
  return uri.starts_with("data:");
}

Result<std::string> decodeDataUri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) {
    return badFormat("its data URI is not base64");
  }
  std::string_view text = uri.substr(comma + 1);
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int bitCount = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int value = base64Value(text[i]);
    if (value < 0) {
      return badFormat("its data URI has byte {} at {}, expected base64",
                       static_cast<int>(static_cast<unsigned char>(text[i])), i);
    }
    bits = (bits << 6 | static_cast<std::uint32_t>(value)) & 0xFFFFFFu;
    bitCount += 6;
    if (bitCount >= 8) {
      bitCount -= 8;
      bytes.push_back(static_cast<char>(bits >> bitCount & 0xFFu));
    }
  }
  return bytes;
}

std::string percentDecoded(std::string_view uri) {
  std::string name;
  name.reserve(uri.size());
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escaped = uri[i] == '%' && i + 2 < uri.size() && hexValue(uri[i + 1]) >= 0 && hexValue(uri[i + 2]) >= 0;
    name.push_back(escaped ? static_cast<char>(16 * hexValue(uri[i + 1]) + hexValue(uri[i + 2])) : uri[i]);
    if (escaped) i += 2;
  }
  return name;
}

}  // namespace lorica
