#include "tests/peers/likeness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace lorica::test {
namespace {

using Color = std::array<int, 3>;

/// A square of one colour, 40 pixels wide with its left side at x, in a white picture of 100 x 60.
MaskedPicture square(int x, Color color) {
  MaskedPicture made;
  made.picture = {100, 60, std::vector<std::uint8_t>(100 * 60 * 4, 255)};
  made.mask = {100, 60, std::vector<std::uint8_t>(100 * 60 * 4, 0)};
  for (int v = 10; v < 50; ++v) {
    for (int u = x; u < x + 40; ++u) {
      const std::size_t at = static_cast<std::size_t>(v * 100 + u) * 4;
      for (std::size_t c = 0; c < 3; ++c) {
        made.picture.rgba[at + c] = static_cast<std::uint8_t>(color[c]);
        made.mask.rgba[at + c] = 255;
      }
    }
  }
  return made;
}

TEST(Likeness, APictureIsLikeItself) {
  const Likeness same = likenessOf(square(20, {90, 0, 200}), square(20, {90, 0, 200}));
  EXPECT_EQ(same.silhouettes, 1.0);
  EXPECT_EQ(same.wrong, 0.0);
  EXPECT_EQ(same.meanDifference, 0.0);
}

TEST(Likeness, SilhouettesAreIntersectionOverUnion) {
  const Likeness moved = likenessOf(square(20, {90, 0, 200}), square(30, {90, 0, 200}));
  EXPECT_DOUBLE_EQ(moved.silhouettes, 30.0 / 50.0);
  EXPECT_EQ(moved.wrong, 0.0);
  EXPECT_EQ(likenessOf(square(0, {0, 0, 0}), square(50, {0, 0, 0})).silhouettes, 0.0);
}

TEST(Likeness, OneChannelMakesAPixelWhollyWrong) {
  EXPECT_EQ(likenessOf(square(20, {90, 0, 200}), square(20, {138, 48, 248})).wrong, 0.0);
  const Likeness wrong = likenessOf(square(20, {90, 0, 200}), square(20, {90, 49, 200}));
  EXPECT_EQ(wrong.wrong, 1.0);
  EXPECT_NEAR(wrong.meanDifference, 49.0 / 3.0, 1e-9);
}

TEST(Likeness, ALineMayMoveByAPixelButNotByTwo) {
  const auto withLine = [](int x) {
    MaskedPicture made = square(20, {200, 200, 200});
    for (int v = 10; v < 50; ++v) {
      for (std::size_t c = 0; c < 3; ++c) made.picture.rgba[static_cast<std::size_t>(v * 100 + x) * 4 + c] = 0;
    }
    return made;
  };
  EXPECT_EQ(likenessOf(withLine(40), withLine(41)).wrong, 0.0);
  EXPECT_DOUBLE_EQ(likenessOf(withLine(40), withLine(42)).wrong, 2.0 / 40.0);
  EXPECT_DOUBLE_EQ(likenessOf(withLine(40), square(20, {200, 200, 200})).wrong, 1.0 / 40.0);
}

TEST(Likeness, PicturesOfDifferentSizesAreNotAlike) {
  MaskedPicture small = square(20, {0, 0, 0});
  small.picture.width = small.mask.width = 50;
  EXPECT_EQ(likenessOf(small, square(20, {0, 0, 0})).wrong, 1.0);
  EXPECT_EQ(likenessOf({}, {}).silhouettes, 0.0);
}

}  // namespace
}  // namespace lorica::test
