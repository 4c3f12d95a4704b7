#include "capture/virtual_sensor/depth_noise.h"

#include "tests/bench/generators/other_cameras.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
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

/// A wall that recedes to the right a little, so that all remainders of the depth steps occur.
std::vector<float> slantedWall(double depth) {
  DepthRenderer renderer{kCamera};
  renderer.clear();
  renderer.drawPlane(Vec3(std::sin(0.1), 0.0, std::cos(0.1)), -depth * std::cos(0.1), 0);
  return {renderer.inverseDepth().begin(), renderer.inverseDepth().end()};
}

/// A near surface from column 320 on before a far one.
std::vector<float> edgeBetween(double near, double far) {
  std::vector<float> inverse = wallAt(far);
  for (std::size_t i = 0; i < kPixels; ++i) {
    if (i % 640 >= 320) inverse[i] = static_cast<float>(1.0 / near);
  }
  return inverse;
}

/// Correlation of the deviations from a depth between pixels at an offset.
double correlation(const Image& image, double depthMm, std::size_t offset) {
  double both = 0.0, one = 0.0;
  for (std::size_t i = 0; i + offset < kPixels; ++i) {
    if (image[i] == 0 || image[i + offset] == 0) continue;
    both += (image[i] - depthMm) * (image[i + offset] - depthMm);
    one += (image[i] - depthMm) * (image[i] - depthMm);
  }
  return both / one;
}

/// Root mean square of the difference of two images, divided by the square root of two: what is new in each [mm].
double newPerFrame(const Image& a, const Image& b) {
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < kPixels; ++i) {
    if (a[i] == 0 || b[i] == 0) continue;
    const double difference = static_cast<double>(a[i]) - b[i];
    squares += difference * difference;
    ++count;
  }
  return std::sqrt(0.5 * squares / count);
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
  // Between pixels of a lattice of cells of 5 pixels; with a tenth of the variance being each pixel's own.
  const Image image = noisy(wallAt(2.0), only(&DepthNoiseSettings::axial));
  EXPECT_NEAR(correlation(image, 2000.0, 1), 0.85, 0.04);
  EXPECT_NEAR(correlation(image, 2000.0, 640), 0.85, 0.04);
  EXPECT_NEAR(correlation(image, 2000.0, 5), 0.22, 0.05);
  EXPECT_NEAR(correlation(image, 2000.0, 20), 0.0, 0.03);
  EXPECT_NEAR(correlation(image, 2000.0, 640 * 20), 0.0, 0.03);
}

TEST(DepthNoise, AFewInAThousandAreMissingInClumps) {
  // Less than the 0.4 % of a normal distribution: the sum of four numbers has thin tails.
  double missing = 0.0, besides = 0.0;
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    const Image image = noisy(wallAt(2.0), only(&DepthNoiseSettings::dropout), frame);
    missing += static_cast<double>(std::count(image.begin(), image.end(), 0));
    for (std::size_t i = 1; i < kPixels; ++i) besides += image[i] == 0 && image[i - 1] == 0 ? 1.0 : 0.0;
  }
  EXPECT_NEAR(missing / (10.0 * kPixels), 0.003, 0.0008);
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

TEST(DepthNoise, EveryKindHasANameAndNothingElseHas) {
  for (int k = 0; k < kDepthNoiseKindCount; ++k) {
    const auto kind = static_cast<DepthNoiseKind>(k);
    EXPECT_FALSE(nameOf(kind).empty());
    EXPECT_EQ(depthNoiseNamed(nameOf(kind)), kind);
  }
  EXPECT_EQ(DepthNoiseSettings::of(DepthNoiseKind::kKinect), DepthNoiseSettings{});
  for (const char* name : {"", "Kinect", "kinect ", "loud"}) EXPECT_FALSE(depthNoiseNamed(name)) << name;
}

TEST(DepthNoise, TheErrorOfAKinectMostlyStays) {
  const double z = 2.8, step = z * z / (8.0 * kCamera.focalX() * 0.075);
  const std::vector<float> wall = slantedWall(z);
  DepthNoiseSettings settings = DepthNoiseSettings::clean();
  settings.axial = settings.steps = 1.0;
  DepthNoise noise(kCamera, settings);
  std::array<Image, 10> frames;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    frames[f].resize(kPixels);
    noise.apply(wall, f, frames[f]);
  }
  // Of deviation s [steps], a tenth of the variance without quantisation: two frames differ in E|s1 - s2| = 2 s /
  // sqrt(pi) of the pixels, by a step.
  const double sigma = (0.0012 + 0.0019 * (z - 0.4) * (z - 0.4)) / step;
  const double own = std::sqrt(0.1 * (sigma * sigma - 1.0 / 12.0));
  int differing = 0, still = 0;
  for (std::size_t i = 0; i < kPixels; ++i) {
    differing += frames[0][i] != frames[9][i] ? 1 : 0;
    still += std::ranges::all_of(frames, [&](const Image& frame) { return frame[i] == frames[0][i]; }) ? 1 : 0;
  }
  EXPECT_NEAR(differing / static_cast<double>(kPixels), 2.0 * own / std::sqrt(M_PI), 0.01);
  // The range of ten normal deviates is 3.08 s (Tippett 1925).
  EXPECT_NEAR(still / static_cast<double>(kPixels), 1.0 - 3.08 * own, 0.03);
}

TEST(DepthNoise, HalfTheResolutionHasTheSameSteps) {
  DepthCamera half = kCamera;
  half.width /= 2;
  half.height /= 2;
  std::vector<float> inverse(kPixels / 4);
  for (std::size_t i = 0; i < inverse.size(); ++i) {
    inverse[i] = static_cast<float>(1.0 / (2.0 + static_cast<double>(i) / static_cast<double>(inverse.size())));
  }
  DepthNoise noise(half, only(&DepthNoiseSettings::steps));
  Image image(inverse.size());
  noise.apply(inverse, 0, image);
  const std::set<std::uint16_t> values(image.begin(), image.end());
  // 1/z goes from 1/2 to 1/3.
  EXPECT_NEAR(static_cast<double>(values.size()), 8.0 * kCamera.focalX() * 0.075 / 6.0, 2.0);
}

TEST(DepthNoise, AStripRightOfNearThingsIsMissing) {
  std::vector<float> inverse = wallAt(3.0);
  for (std::size_t i = 0; i < kPixels; ++i) {
    if (i % 640 >= 250 && i % 640 < 350) inverse[i] = 1.0F / 1.5F;
  }
  const Image image = noisy(inverse, only(&DepthNoiseSettings::edgeLoss));
  for (std::size_t column = 0; column < 640; ++column) {
    ASSERT_EQ(image[200 * 640 + column] == 0, column >= 350 && column < 353) << column;
  }
  // A step of less than four pixels of disparity is no edge.
  for (std::size_t i = 0; i < kPixels; ++i) inverse[i] = i % 640 < 350 ? 1.0F / 2.5F : 1.0F / 3.0F;
  const Image low = noisy(inverse, only(&DepthNoiseSettings::edgeLoss));
  EXPECT_EQ(std::ranges::count(low, 0), 0);
}

TEST(DepthNoise, ARealSenseHasSmoothNoiseThatGrowsWithTheDistance) {
  const DepthNoiseSettings settings = realSenseNoise();
  for (const double z : {1.5, 2.0, 3.0}) {
    const Image image = noisy(wallAt(z), settings), next = noisy(wallAt(z), settings, 1);
    const double expected = 1000.0 * (0.0005 + 0.0074 * (z - 0.9) * (z - 0.9));
    const Spread spread = percentilesOf(image);
    EXPECT_NEAR(spread.deviation, expected, 0.12 * expected + 0.2) << z;
    EXPECT_NEAR(newPerFrame(image, next), std::sqrt(0.7) * expected, 0.12 * expected + 0.2) << z;
    EXPECT_GT(spread.count, 0.999 * kPixels) << z;
    EXPECT_NEAR(correlation(image, spread.mean, 2), 0.9, 0.06) << z;
    EXPECT_NEAR(correlation(image, spread.mean, 20), 0.22, 0.1) << z;
    EXPECT_NEAR(correlation(image, spread.mean, 60), 0.0, 0.08) << z;
  }
}

TEST(DepthNoise, ARealSenseSmearsEdgesAndFillsHoles) {
  DepthNoiseSettings settings = DepthNoiseSettings::clean();
  settings.smear = realSenseNoise().smear;
  const Image image = noisy(edgeBetween(2.0, 3.5), settings);
  // A box of 12 pixels twice is a triangle: from 15 to 85 % of inverse depth in (2 - 2 sqrt(0.3)) 12 pixels.
  const std::uint16_t* row = &image[200UL * 640];
  const auto at = [&](double part) { return 1000.0 / (1.0 / 3.5 + part * (1.0 / 2.0 - 1.0 / 3.5)); };
  int ramp = 0;
  for (std::size_t column = 0; column < 640; ++column) {
    ramp += row[column] < at(0.15) && row[column] > at(0.85) ? 1 : 0;
    if (column < 307) {
      ASSERT_EQ(row[column], 3500) << column;
    }
    if (column > 332) {
      ASSERT_EQ(row[column], 2000) << column;
    }
    if (column > 0) {
      ASSERT_LE(row[column], row[column - 1]) << column;
    }
  }
  EXPECT_NEAR(ramp, 12.0 * (2.0 - 2.0 * std::sqrt(0.3)), 1.0);

  std::vector<float> holed = wallAt(2.0);
  for (std::size_t row2 = 200; row2 < 206; ++row2)
    std::fill_n(holed.begin() + static_cast<int>(row2) * 640 + 300, 6, 0.0F);
  for (const std::uint16_t mm : noisy(holed, settings)) ASSERT_EQ(mm, 2000);
}

TEST(DepthNoise, TimeOfFlightHasTheNoiseOfFankhauserAndOthers) {
  for (const double z : {1.0, 2.0, 4.0}) {
    const Image image = noisy(wallAt(z), timeOfFlightNoise());
    const double expected = 1.5 - 0.5 * z + 0.3 * z * z;
    const Spread spread = percentilesOf(image);
    // Whole millimetres add a twelfth to the variance.
    EXPECT_NEAR(spread.deviation, std::sqrt(expected * expected + 1.0 / 12.0), 0.06 * expected) << z;
    EXPECT_NEAR(spread.mean, 1000.0 * z, 0.3) << z;
    EXPECT_NEAR(correlation(image, spread.mean, 1), 0.0, 0.02) << z;
  }
  EXPECT_EQ(percentilesOf(noisy(wallAt(4.4), timeOfFlightNoise())).count > 0, true);
  const Image beyond = noisy(wallAt(4.6), timeOfFlightNoise());
  EXPECT_EQ(std::ranges::count(beyond, 0), static_cast<long>(kPixels));
}

TEST(DepthNoise, TimeOfFlightSeesMixedPixelsAtEdges) {
  DepthNoiseSettings settings = timeOfFlightNoise();
  settings.sensor = kCamera;
  settings.axial = settings.lateral = settings.dropout = 0.0;
  const Image image = noisy(edgeBetween(2.0, 3.5), settings);
  int mixed = 0;
  for (std::size_t column = 0; column < 640; ++column) {
    const std::uint16_t mm = image[200 * 640 + column];
    mixed += mm != 2000 && mm != 3500 ? 1 : 0;
    ASSERT_GE(mm, 2000);
    ASSERT_LE(mm, 3500);
  }
  EXPECT_EQ(mixed, 2);
}

TEST(DepthNoise, TheSameSeedAndFrameGiveTheSameImage) {
  const std::vector<float> inverse = edgeBetween(2.0, 3.0);
  for (const std::string_view camera : {"kinect", "realsense", "tof", "mild"}) {
    DepthNoiseSettings settings = noiseNamed(camera);
    DepthNoise noise(kCamera, settings);
    Image first(kPixels), other(kPixels), again(kPixels);
    noise.apply(inverse, 3, first);
    noise.apply(inverse, 4, other);
    noise.apply(inverse, 3, again);
    EXPECT_EQ(first, again) << camera;
    EXPECT_NE(first, other) << camera;
    settings.seed = 5;
    EXPECT_NE(first, noisy(inverse, settings, 3)) << camera;
  }
}

TEST(DepthNoise, AFrameAllocatesNothing) {
  const std::vector<float> inverse = wallAt(2.0);
  for (const std::string_view name : kCameraNames) {
    DepthNoise noise(kCamera, noiseNamed(name));
    Image image(kPixels);
    const long before = test::allocationCount();
    noise.apply(inverse, 3, image);
    EXPECT_EQ(test::allocationCount(), before) << name;
  }
}

TEST(DepthNoise, AnyCameraGetsAnImage) {
  for (const auto& [width, height] : {std::pair{2, 2}, std::pair{3, 7}, std::pair{64, 48}, std::pair{641, 479}}) {
    DepthCamera camera;
    camera.width = width;
    camera.height = height;
    const std::vector<float> inverse(static_cast<std::size_t>(width * height), 0.5F);
    for (const std::string_view name : kCameraNames) {
      DepthNoise noise(camera, noiseNamed(name));
      Image image(inverse.size());
      noise.apply(inverse, 0, image);
      for (const std::uint16_t mm : image) {
        if (mm != 0) {
          ASSERT_NEAR(mm, 2000.0, 100.0) << width << ' ' << name;
        }
      }
    }
  }
}

}  // namespace
}  // namespace lorica
