#include "viewer/renderer/text.h"

#include "viewer/renderer/font.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <sstream>
#include <string>

namespace lorica {
namespace {

long ink(const TextMask& mask) {
  return std::accumulate(mask.coverage.begin(), mask.coverage.end(), 0L);
}

TEST(Text, CharactersOfUtf8) {
  EXPECT_EQ(charactersOf("plain 123"), U"plain 123");
  EXPECT_EQ(charactersOf("5 \u00b5s \u2013 3\u00d74"), U"5 \u00b5s \u2013 3\u00d74");
  EXPECT_EQ(charactersOf("\u732b\U0001f600!"), U"\u732b\U0001f600!");
  EXPECT_EQ(charactersOf("a\x01z\n\t"), U"a z\n\t");
  EXPECT_EQ(charactersOf("\xff\xfe"), U"\ufffd\ufffd");  // not UTF-8 at all
  EXPECT_EQ(charactersOf(std::string_view("\u732b").substr(0, 2)), U"\ufffd") << "cut";
}

TEST(Text, SignsBeyondAsciiAreThemselves) {
  for (const char* sign : {"\u00b5", "\u2013", "\u00d7", "\u00e9", "\u0416", "\u03a9"}) {
    EXPECT_NE(drawText(sign, 28).coverage, drawText("?", 28).coverage) << sign;
    EXPECT_NE(drawText(sign, 28).coverage, drawText("\ufffd", 28).coverage) << sign;
    EXPECT_GT(ink(drawText(sign, 28)), 0) << sign;
  }
  EXPECT_GT(ink(drawText("\U000f0000", 28)), 0) << "what no font has is marked";
}

TEST(Text, FitsItsMaskAndGrowsWithIt) {
  const TextMask small = drawText("Lorica", 14);
  const TextMask large = drawText("Lorica", 28);
  EXPECT_EQ(small.height, 14);
  EXPECT_EQ(large.height, 28);
  EXPECT_NEAR(large.width, 2.0 * small.width, 3.0);
  EXPECT_GT(ink(small), 0);
  EXPECT_NEAR(static_cast<double>(ink(large)) / static_cast<double>(ink(small)), 4.0, 0.6);
  // Nothing is clipped: the rim of the mask is empty.
  for (int x = 0; x < large.width; ++x) {
    EXPECT_EQ(large.coverage[x], 0);
    EXPECT_EQ(large.coverage[(large.height - 1) * large.width + x], 0);
  }
}

TEST(Text, LinesGoBelowOneAnother) {
  const TextMask one = drawText("wide line", 20);
  const TextMask two = drawText("wide line\ni", 20);
  EXPECT_EQ(two.height, 2 * one.height);
  EXPECT_EQ(two.width, one.width);
  EXPECT_GT(ink(two), ink(one));
}

TEST(Text, FittedLinesAreNoWiderThanAskedAndLoseNoWord) {
  const std::string text = "jumping_jacks   2.1 s   16 convex parts   touching 3 props   beyond training";
  for (const int width : {90, 120, 200, 276, 400, 2000}) {
    const std::string fitted = fittedText(text, 12, width);
    EXPECT_LE(drawText(fitted, 12).width, width) << fitted;
    std::string joined = fitted;
    std::replace(joined.begin(), joined.end(), '\n', ' ');
    std::istringstream got(joined), wanted(text);
    for (std::string a, b; wanted >> b;) {
      ASSERT_TRUE(got >> a);
      if (width > 90) {
        EXPECT_EQ(a, b);
      }
    }
  }
  EXPECT_EQ(fittedText(text, 12, 2000), text) << "text that fits is unchanged";
  EXPECT_GT(std::ranges::count(fittedText(text, 12, 200), '\n'), 0);
  const std::string cut = fittedText("a_name_without_any_blank_in_it.bvh", 12, 80);
  EXPECT_TRUE(cut.starts_with("a_name") && cut.ends_with("..")) << cut;
  EXPECT_LE(drawText(cut, 12).width, 80);
  EXPECT_EQ(fittedText("", 12, 80), "");
}

TEST(Text, DescendersStayInTheirLine) {
  const TextMask mask = drawText("gjpqy", 24);
  for (int x = 0; x < mask.width; ++x) {
    EXPECT_EQ(mask.coverage[(mask.height - 1) * mask.width + x], 0);
  }
}

TEST(Text, EmptyAndTinyTextIsNoTrouble) {
  EXPECT_EQ(ink(drawText("", 20)), 0);
  EXPECT_GT(drawText("", 20).width, 0);
  EXPECT_EQ(drawText("x", -5).height, 6);
}

TEST(TextDeathTest, WithoutFontsThereIsNoLetteringAndOneNotice) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a new process, which has asked for no font yet
  const auto drawWithout = [] {
    setenv("LORICA_FONTS", "/nowhere", 1);
    const TextMask mask = drawText("hull", 20);
    std::exit(ink(mask) == 0 && mask.width > 20 ? 0 : 1);
  };
  EXPECT_EXIT(drawWithout(), testing::ExitedWithCode(0), "^lorica: pictures have no lettering[^\n]*\n$");
}

TEST(Text, PanelIsPremultiplied) {
  const Image panel = drawTextPanel("caption", 20);
  int solid = 0;
  for (std::size_t i = 0; i < panel.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LE(panel.rgba[i + c], panel.rgba[i + 3]);
    solid += panel.rgba[i + 3] > 240;
  }
  EXPECT_GT(solid, 50);
  EXPECT_EQ(panel.rgba[3], 0) << "corners are round";
}

}  // namespace
}  // namespace lorica
