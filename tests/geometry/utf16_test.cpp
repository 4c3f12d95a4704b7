#include "geometry/text.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

std::string utf16(const std::u16string& text, bool little) {
  std::string bytes;
  for (const char16_t unit : text) {
    bytes += static_cast<char>(little ? unit & 0xff : unit >> 8);
    bytes += static_cast<char>(little ? unit >> 8 : unit & 0xff);
  }
  return bytes;
}

TEST(Utf16, BothOrdersWithAndWithoutAMark) {
  for (const bool little : {true, false}) {
    EXPECT_EQ(asUtf8(utf16(u"\ufeffH\u00e9\u20ac\U0001f600", little)), "H\u00e9\u20ac\U0001f600");
    EXPECT_EQ(asUtf8(utf16(u"HIERARCHY", little)), "HIERARCHY");
  }
}

TEST(Utf16, OtherTextStaysAsItIs) {
  for (const std::string text : {"", "H", "HIERARCHY", "\xef\xbb\xbfHIERARCHY", "\xc3\xa9"})
    EXPECT_EQ(asUtf8(text), text);
}

TEST(Utf16, EveryPrefixAndHalvesOfPairsAreRead) {
  const std::string whole = utf16(u"\ufeffA\U0001f600B\xd800", true);
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const std::string text = asUtf8(whole.substr(0, size));
    EXPECT_LE(text.size(), 3 * whole.size());
  }
  EXPECT_EQ(asUtf8(utf16(u"AB\xd800", true)), "AB");
}

}  // namespace
}  // namespace lorica
