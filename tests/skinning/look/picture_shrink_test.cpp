#include "skinning/look/picture_shrink.h"
#include "geometry/work_budgets.h"

#include "tests/skinning/look/picture_samples.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace lorica::test {
namespace {

/// Length that two intervals share.
double shared(double from, double to, double otherFrom, double otherTo) {
  return std::max(0.0, std::min(to, otherTo) - std::max(from, otherFrom));
}

/// One pixel of a reduced picture, from the definition: a sum over all stored pixels.
std::array<double, 4> meanOver(const Picture& picture, PictureSize to, int column, int row) {
  std::array<double, 3> weighted{}, plain{};
  double alpha = 0.0, area = 0.0;
  const double across = static_cast<double>(picture.width) / to.width;
  const double down = static_cast<double>(picture.height) / to.height;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double part =
          shared(column * across, (column + 1) * across, x, x + 1) * shared(row * down, (row + 1) * down, y, y + 1);
      const std::uint8_t* pixel = &picture.rgba[(static_cast<std::size_t>(y) * picture.width + x) * 4];
      for (std::size_t c = 0; c < 3; ++c) {
        weighted[c] += part * pixel[3] * pixel[c];
        plain[c] += part * pixel[c];
      }
      alpha += part * pixel[3];
      area += part;
    }
  }
  std::array<double, 4> mean{0.0, 0.0, 0.0, alpha / area};
  for (std::size_t c = 0; c < 3; ++c) mean[c] = alpha > 0.0 ? weighted[c] / alpha : plain[c] / area;
  return mean;
}

TEST(PictureShrink, SizesKeepProportions) {
  const auto expectSize = [](PictureSize from, int side, int width, int height) {
    const PictureSize to = limitedSize(from, side);
    EXPECT_EQ(to.width, width);
    EXPECT_EQ(to.height, height);
  };
  expectSize({4096, 2048}, 1024, 1024, 512);
  expectSize({100, 300}, 150, 50, 150);
  expectSize({100, 300}, 0, 100, 300);
  expectSize({100, 300}, 300, 100, 300);
  expectSize({100, 300}, 1, 1, 1);
  expectSize({16384, 1}, 16383, 16383, 1);
  expectSize({16384, 3}, 100, 100, 1);
  expectSize({7, 5}, 3, 3, 2);
}

TEST(PictureShrink, EqualsTheMeanOverEachArea) {
  std::mt19937 random(18);
  for (int i = 0; i < 60; ++i) {
    const auto size = [&] { return static_cast<int>(1 + random() % 40); };
    const PictureSize from{size(), size()};
    const PictureSize to{static_cast<int>(1 + random() % static_cast<unsigned int>(from.width)),
                         static_cast<int>(1 + random() % static_cast<unsigned int>(from.height))};
    SCOPED_TRACE(testing::Message() << from.width << " x " << from.height << " to " << to.width << " x " << to.height);
    Picture picture = noisePicture(from.width, from.height, random());
    for (std::size_t p = 3; p < picture.rgba.size(); p += 4) {
      if (random() % 3 == 0) picture.rgba[p] = 0;
    }
    PictureShrink shrink(from, to);
    const auto rowBytes = static_cast<std::size_t>(from.width) * 4;
    for (std::size_t y = 0; y < static_cast<std::size_t>(from.height); ++y) {
      shrink.add(std::span(picture.rgba).subspan(y * rowBytes, rowBytes));
    }
    const Picture small = shrink.take();
    ASSERT_EQ(small.width, to.width);
    ASSERT_EQ(small.height, to.height);
    for (int row = 0; row < to.height; ++row) {
      for (int column = 0; column < to.width; ++column) {
        const auto mean = meanOver(picture, to, column, row);
        for (std::size_t c = 0; c < 4; ++c) {
          EXPECT_NEAR(small.rgba[(static_cast<std::size_t>(row) * to.width + column) * 4 + c], mean[c], 0.5 + 1e-9);
        }
      }
    }
  }
}

TEST(PictureShrink, TransparentPixelsGiveNoColour) {
  const Picture picture{2, 2, {255, 0, 0, 0, 0, 0, 200, 255, 255, 0, 0, 0, 0, 0, 200, 255}};
  EXPECT_EQ(shrunk(picture, 1).rgba, (std::vector<std::uint8_t>{0, 0, 200, 128}));
  // Without any alpha the colours remain: a material may ignore alpha.
  const Picture clear{2, 1, {100, 50, 0, 0, 200, 50, 0, 0}};
  EXPECT_EQ(shrunk(clear, 1).rgba, (std::vector<std::uint8_t>{150, 50, 0, 0}));
}

TEST(PictureShrink, TheLargestSumsFit) {
  const Picture white{kMaxPictureSide, 4096, std::vector<std::uint8_t>(std::size_t{kMaxPictureSide} * 4096 * 4, 255)};
  for (const std::uint8_t value : shrunk(white, 3).rgba) EXPECT_EQ(value, 255);
}

TEST(PictureShrink, OneColourStaysTheSame) {
  Picture picture{33, 47, {}};
  for (int i = 0; i < 33 * 47; ++i) picture.rgba.insert(picture.rgba.end(), {1, 77, 254, 3});
  for (int side = 1; side <= 47; ++side) {
    const Picture small = shrunk(picture, side);
    EXPECT_EQ(small.height, side);
    for (std::size_t i = 0; i < small.rgba.size(); ++i) EXPECT_EQ(small.rgba[i], picture.rgba[i % 4]);
  }
}

}  // namespace
}  // namespace lorica::test
