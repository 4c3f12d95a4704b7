#include "capture/virtual_sensor/depth_noise.h"

#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace lorica {
namespace {

constexpr DepthCamera kCamera;
constexpr std::size_t kPixels = 640UL * 480UL;

using Image = std::vector<std::uint16_t>;

std::vector<float> wallAt(double depth) {
  return std::vector<float>(kPixels, static_cast<float>(1.0 / depth));
}

Image noisy(std::span<const float> inverseDepth, const DepthNoiseSettings& settings, std::uint64_t frame = 0) {
  DepthNoise noise(kCamera, settings);
  Image image(kPixels, 1);
  noise.apply(inverseDepth, frame, image);
  return image;
}

/// Settings with one kind of noise only.
DepthNoiseSettings only(double DepthNoiseSettings::*kind) {
  DepthNoiseSettings settings = DepthNoiseSettings::clean();
  settings.*kind = DepthNoiseSettings{}.*kind;
  return settings;
}

struct Spread {
  double mean = 0.0, deviation = 0.0;
  int count = 0;
};
Spread percentilesOf(const Image& image) {
  Spread spread;
  double squares = 0.0;
  for (const std::uint16_t mm : image) {
    if (mm == 0) continue;
    ++spread.count;
    spread.mean += mm;
    squares += static_cast<double>(mm) * mm;
  }
  spread.mean /= spread.count;
  spread.deviation = std::sqrt(squares / spread.count - spread.mean * spread.mean);
  return spread;
}

TEST(DepthNoise, CleanDepthIsRoundedToMillimetresWithinTheRange) {
  std::vector<float> inverse(kPixels, 0.0F);
  const auto put = [&](std::size_t at, double depth) { inverse[at] = static_cast<float>(1.0 / depth); };
  put(0, 0.4999);
  put(1, 0.5001);
  put(2, 2.34561);
  put(3, 2.34639);
  put(4, 7.9998);
  put(5, 8.0002);
  const Image image = noisy(inverse, DepthNoiseSettings::clean());
  EXPECT_EQ(image[0], 0);
  EXPECT_EQ(image[1], 500);
  EXPECT_EQ(image[2], 2346);
  EXPECT_EQ(image[3], 2346);
  EXPECT_EQ(image[4], 8000);
  EXPECT_EQ(image[5], 0);
  EXPECT_EQ(image[6], 0);
  for (double depth = 0.501; depth < 8.0; depth += 0.307) {
    const Image wall = noisy(wallAt(depth), DepthNoiseSettings::clean());
    ASSERT_NEAR(wall[1000], 1000.0 * depth, 0.6);
  }
}

TEST(DepthNoise, StepsGrowWithTheSquareOfTheDistance) {
  std::set<std::uint16_t> values;
  std::vector<float> inverse(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) {
    inverse[i] = static_cast<float>(1.0 / (0.5 + 7.5 * static_cast<double>(i) / static_cast<double>(kPixels)));
  }
  for (const std::uint16_t mm : noisy(inverse, only(&DepthNoiseSettings::steps))) values.insert(mm);
  values.erase(0);
  for (auto it = values.begin(); std::next(it) != values.end(); ++it) {
    const double z = 0.0005 * (*it + *std::next(it));
    EXPECT_NEAR(0.001 * (*std::next(it) - *it), z * z / (8.0 * kCamera.focalX() * 0.075), 0.0011) << z;
  }
  EXPECT_GT(values.size(), 500U);
}

TEST(DepthNoise, AWallHasTheAxialNoiseOfNguyenAndOthers) {
  for (const double z : {0.8, 1.5, 2.5, 4.0}) {
    DepthNoiseSettings settings = DepthNoiseSettings::clean();
    settings.axial = settings.steps = 1.0;
    const Spread spread = percentilesOf(noisy(wallAt(z), settings));
    const double expected = 1000.0 * (0.0012 + 0.0019 * (z - 0.4) * (z - 0.4));
    EXPECT_NEAR(spread.deviation, expected, 0.08 * expected + 0.2) << z;
    EXPECT_NEAR(spread.mean, 1000.0 * z, 0.03 * expected + 1.0 + 1.5e-3 * 1000.0 * z) << z;
    EXPECT_EQ(spread.count, static_cast<int>(kPixels));
  }
}

TEST(DepthNoise, NeighboursErrAlikeAndDistantPixelsDoNot) {
  const Image image = noisy(wallAt(2.0), only(&DepthNoiseSettings::axial));
  const auto correlation = [&](std::size_t offset) {
    double both = 0.0, one = 0.0;
    for (std::size_t i = 0; i + offset < kPixels; ++i) {
      both += (image[i] - 2000.0) * (image[i + offset] - 2000.0);
      one += (image[i] - 2000.0) * (image[i] - 2000.0);
    }
    return both / one;
  };
  EXPECT_GT(correlation(1), 0.4);
  EXPECT_LT(correlation(1), 0.65);
  EXPECT_NEAR(correlation(20), 0.0, 0.02);
  EXPECT_NEAR(correlation(640 * 20), 0.0, 0.02);
}

TEST(DepthNoise, AFewPercentAreMissingInClumps) {
  const Image image = noisy(wallAt(2.0), only(&DepthNoiseSettings::dropout));
  const auto missing = static_cast<double>(std::count(image.begin(), image.end(), 0));
  EXPECT_NEAR(missing / static_cast<double>(kPixels), 0.02, 0.006);
  int besides = 0;
  for (std::size_t i = 1; i < kPixels; ++i) besides += image[i] == 0 && image[i - 1] == 0 ? 1 : 0;
  EXPECT_GT(besides, 0.5 * missing);
}

TEST(DepthNoise, TheProjectorsShadowLiesLeftOfNearThingsAndIsAsWideAsParallaxSays) {
  std::vector<float> inverse = wallAt(3.0);
  for (std::size_t row = 100; row < 300; ++row) {
    for (std::size_t column = 250; column < 350; ++column) inverse[row * 640 + column] = 1.0F / 1.5F;
  }
  const Image image = noisy(inverse, only(&DepthNoiseSettings::baseline));
  const double parallax = kCamera.focalX() * 0.075 * (1.0 / 1.5 - 1.0 / 3.0);
  int width = 0;
  for (std::size_t column = 0; column < 640; ++column) {
    if (image[200 * 640 + column] != 0) continue;
    EXPECT_LT(column, 250U);
    EXPECT_GE(column, 250U - 20U);
    ++width;
  }
  EXPECT_NEAR(width, parallax, 1.5);  // whole pixels, with a tolerance of half a pixel
  for (std::size_t column = 0; column < 640; ++column) ASSERT_NE(image[50 * 640 + column], 0);
}

TEST(DepthNoise, EdgesJitterByAboutAPixel) {
  std::vector<float> inverse = wallAt(3.0);
  for (std::size_t i = 0; i < kPixels; ++i) {
    if (i % 640 >= 320) inverse[i] = 1.0F / 1.5F;
  }
  const Image image = noisy(inverse, only(&DepthNoiseSettings::lateral));
  // Along an edge the number of near pixels on the wrong side adds up to the mean of |offset|.
  double offset = 0.0, squares = 0.0;
  for (std::size_t row = 0; row < 480; ++row) {
    int near = 0;
    for (std::size_t column = 300; column < 340; ++column) near += image[row * 640 + column] == 1500 ? 1 : 0;
    offset += near - 20;
    squares += (near - 20) * (near - 20);
  }
  EXPECT_NEAR(offset / 480.0, 0.0, 0.3);
  EXPECT_GT(std::sqrt(squares / 480.0), 0.3);
  EXPECT_LT(std::sqrt(squares / 480.0), 1.5);
  EXPECT_EQ(image[200 * 640 + 100], 3000);
}

TEST(DepthNoise, GrazingSurfacesGoMissing) {
  DepthRenderer renderer{kCamera};
  const auto missingAt = [&](double angle) {
    // A wall rotated about the vertical; only its middle columns are seen at about that angle.
    renderer.clear();
    renderer.drawPlane(Vec3(std::sin(angle), 0.0, std::cos(angle)), -2.0 * std::cos(angle), 0);
    DepthNoiseSettings settings = DepthNoiseSettings::clean();
    settings.grazing = true;
    const Image image = noisy(renderer.inverseDepth(), settings);
    int missing = 0;
    for (std::size_t row = 0; row < 480; ++row) {
      for (std::size_t column = 315; column < 325; ++column) missing += image[row * 640 + column] == 0 ? 1 : 0;
    }
    return missing / 4800.0;
  };
  EXPECT_EQ(missingAt(0.0), 0.0);
  EXPECT_EQ(missingAt(65.0 * M_PI / 180.0), 0.0);
  EXPECT_NEAR(missingAt(76.7 * M_PI / 180.0), 0.5, 0.25);
  EXPECT_GT(missingAt(85.0 * M_PI / 180.0), 0.98);
}

TEST(DepthNoise, TheSameSeedAndFrameGiveTheSameImage) {
  const std::vector<float> inverse = wallAt(2.0);
  DepthNoise noise(kCamera, {});
  Image first(kPixels), other(kPixels), again(kPixels);
  noise.apply(inverse, 3, first);
  noise.apply(inverse, 4, other);
  noise.apply(inverse, 3, again);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
  DepthNoiseSettings seeded;
  seeded.seed = 5;
  EXPECT_NE(first, noisy(inverse, seeded, 3));
}

TEST(DepthNoise, AFrameAllocatesNothing) {
  const std::vector<float> inverse = wallAt(2.0);
  DepthNoise noise(kCamera, {});
  Image image(kPixels);
  const long before = test::allocationCount();
  noise.apply(inverse, 3, image);
  EXPECT_EQ(test::allocationCount(), before);
}

}  // namespace
}  // namespace lorica
