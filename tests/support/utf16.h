#pragma once

#include <string>
#include <string_view>

namespace lorica::test {

/// The bytes of a text in UTF-16, without a byte order mark. @param little  the least significant byte first
[[nodiscard]] inline std::string utf16(std::u16string_view text, bool little) {
  std::string bytes;
  for (const char16_t unit : text) {
    bytes += static_cast<char>(little ? unit & 0xff : unit >> 8);
    bytes += static_cast<char>(little ? unit >> 8 : unit & 0xff);
  }
  return bytes;
}

/// The same of a text in ASCII. @param mark  begins with a byte order mark
[[nodiscard]] inline std::string asUtf16(std::string_view ascii, bool little, bool mark) {
  return utf16((mark ? u"\ufeff" : u"") + std::u16string(ascii.begin(), ascii.end()), little);
}

}  // namespace lorica::test
