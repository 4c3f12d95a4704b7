#include "geometry/text.h"

#include "geometry/random_numbers.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

TEST(Printable, KeepsTextAndEscapesTheRest) {
  EXPECT_EQ(printable("hero.glb: 12 'joints'"), "hero.glb: 12 'joints'");
  EXPECT_EQ(printable("Größe 身長 🦾"), "Größe 身長 🦾");
  EXPECT_EQ(printable("a\nb\r\t\x1b[2J\x7f"), "a\\x0ab\\x0d\\x09\\x1b[2J\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xC2\x9B"
                      "1m"),
            "\\xc2\\x9b1m")
      << "a control character of two bytes";
  EXPECT_EQ(printable("\xE8\xBA"), "\\xe8\\xba") << "the beginning of a character";
  EXPECT_EQ(printable("\xC0\xAF \xFF"), "\\xc0\\xaf \\xff") << "no UTF-8";
}

TEST(Printable, ReplacesTheMiddleOfLongText) {
  EXPECT_EQ(printable("0123456789", 10), "0123456789");
  EXPECT_EQ(printable("0123456789abcdefghij", 9), "012345 ... (11 bytes) ... hij");
  EXPECT_EQ(printable("長長長長", 6), "長 ... (9 bytes) ... ") << "no part of a character";
}

TEST(Printable, IsOneLineAndStaysAsItIs) {
  RandomNumbers random(21);
  for (int round = 0; round < 2000; ++round) {
    std::string text(20, ' ');
    for (char& c : text) c = static_cast<char>(random.bits() >> 56U);
    const std::string once = printable(text);
    for (const char c : once) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) << once;
    EXPECT_EQ(printable(once), once);
  }
}

}  // namespace
}  // namespace lorica
