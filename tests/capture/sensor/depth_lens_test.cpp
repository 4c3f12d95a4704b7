#include "capture/sensor/depth_lens.h"

#include "geometry/math.h"
#include "tests/support/has.h"
#include "tests/support/lens_rays.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace lorica {
namespace {

using test::valueOf;

/// A depth along the axis of each ray (x, y, 1) [m]; 0 = nothing is there.
using Scene = std::function<double(double, double)>;

double tiltedPlane(double x, double y) {
  return 2.5 / (1.0 + 0.3 * x - 0.4 * y);
}
double sphereBeforeAWall(double x, double y) {
  const Vec3 ray(x, y, 1.0), middle(0.3, -0.2, 2.0);
  const double a = ray.squaredNorm(), b = ray.dot(middle), c = middle.squaredNorm() - 0.5 * 0.5;
  return b * b > a * c ? (b - std::sqrt(b * b - a * c)) / a : 4.0;
}

std::vector<std::uint16_t> seenBy(const DepthLens& lens, const Scene& scene) {
  std::vector<std::uint16_t> image;
  for (int row = 0; row < lens.height; ++row) {
    for (int column = 0; column < lens.width; ++column) {
      const Eigen::Vector2d ray = test::rayOfPixel(lens, column, row);
      image.push_back(static_cast<std::uint16_t>(std::lround(scene(ray.x(), ray.y()) / lens.metresPerUnit)));
    }
  }
  return image;
}

struct NamedLens {
  const char* name;
  DepthLens lens;
};

std::vector<NamedLens> lenses() {
  const auto make = [](int width, int height, double f, double x, double y, std::array<double, 8> d, double unit) {
    return DepthLens{width, height, f, f * 1.001, x, y, d, unit};
  };
  // The first two are real calibrations, that others published.
  return {{"Azure Kinect, narrow, binned",
           make(320, 288, 251.9, 165.8, 162.7,
                {3.130577, 2.324939, 0.0000813, -0.0000511, 0.130416, 3.458652, 3.350115, 0.662942}, 0.001)},
          {"Kinect v2",
           make(512, 424, 365.456, 254.878, 205.395, {0.0905474, -0.26819, 0.0, 0.0, 0.0950862, 0, 0, 0}, 0.001)},
          {"wide, barrel", make(320, 240, 160.0, 150.0, 125.0, {-0.2, 0.04, 0.001, -0.002, -0.002, 0, 0, 0}, 0.0005)},
          {"90 degrees, straight, off centre", make(300, 200, 150.0, 130.3, 111.7, {}, 0.00025)},
          {"upright", make(192, 256, 220.0, 95.5, 127.5, {0.05, 0, 0, 0, 0, 0, 0, 0}, 0.001)}};
}

TEST(DepthRectifier, ADistortedImageShowsWhatAPinholeSees) {
  for (const auto& [name, lens] : lenses()) {
    for (const Scene& scene : {Scene(tiltedPlane), Scene(sphereBeforeAWall)}) {
      const DepthRectifier rectifier = valueOf(DepthRectifier::create(lens));
      const DepthCamera& camera = rectifier.camera();
      std::vector<std::uint16_t> made;
      rectifier.apply(seenBy(lens, scene), made);
      ASSERT_EQ(made.size(), static_cast<std::size_t>(camera.width) * camera.height) << name;
      std::size_t measured = 0;
      for (int row = 0; row < camera.height; ++row) {
        for (int column = 0; column < camera.width; ++column) {
          const double depth = 1e-3 * made[static_cast<std::size_t>(row) * camera.width + column];
          if (depth == 0.0) continue;
          ++measured;
          const double x = (column + 0.5 - 0.5 * camera.width) / camera.focalX();
          const double y = (row + 0.5 - 0.5 * camera.height) / camera.focalY();
          // The nearest pixel of the camera is at most 0.71 of its pixels away, which the lens may enlarge.
          const double pixel = 1.2 / std::min(lens.focalX, camera.focalX());
          double low = 1e9, high = 0.0;
          for (const double right : {-pixel, 0.0, pixel}) {
            for (const double down : {-pixel, 0.0, pixel}) {
              const double there = scene(x + right, y + down);
              low = std::min(low, there);
              high = std::max(high, there);
            }
          }
          ASSERT_GE(depth, low - 0.002) << name << " at " << column << ", " << row;
          ASSERT_LE(depth, high + 0.002) << name << " at " << column << ", " << row;
        }
      }
      EXPECT_GT(static_cast<double>(measured), 0.75 * static_cast<double>(made.size())) << name;
      EXPECT_LE(made.size(), 1.3 * lens.width * lens.height) << name;
    }
  }
}

TEST(DepthRectifier, TheMiddleRowAndColumnAreKeptWhole) {
  for (const auto& [name, lens] : lenses()) {
    const DepthCamera camera = valueOf(DepthRectifier::create(lens)).camera();
    for (const auto& [column, row] : {std::pair(0.0, lens.centreY),
                                      {lens.width - 1.0, lens.centreY},
                                      {lens.centreX, 0.0},
                                      {lens.centreX, lens.height - 1.0}}) {
      const Eigen::Vector2d ray = test::rayOfPixel(lens, column, row);
      // The reach is that without the tangential part, which is a hundredth.
      EXPECT_LE(std::abs(ray.x()), 1.02 * std::tan(0.5 * camera.horizontalFov)) << name;
      EXPECT_LE(std::abs(ray.y()), 1.02 * std::tan(0.5 * camera.verticalFov)) << name;
    }
  }
}

TEST(DepthRectifier, ACentredPinholeStaysAsItIs) {
  DepthLens lens = DepthLens::pinhole(64, 48, 1.0, 0.8);
  std::vector<std::uint16_t> raw(64 * 48), made;
  std::iota(raw.begin(), raw.end(), std::uint16_t{1});
  valueOf(DepthRectifier::create(lens)).apply(raw, made);
  EXPECT_EQ(made, raw);
  lens.metresPerUnit = 0.0002;
  valueOf(DepthRectifier::create(lens)).apply(raw, made);
  EXPECT_EQ(made[999], 200);
  lens.metresPerUnit = 0.1;
  valueOf(DepthRectifier::create(lens)).apply(raw, made);
  EXPECT_EQ(made[99], 10000);
  EXPECT_EQ(made[999], 0) << "beyond what fits";
}

TEST(DepthRectifier, WhatIsBehindTheLensIsNotSeen) {
  // The image of a strong barrel ends where rays further out would come back.
  DepthLens lens{200, 200, 60.0, 60.0, 99.5, 99.5, {-0.1, 0, 0, 0, 0, 0, 0, 0}, 0.001};
  const DepthRectifier rectifier = valueOf(DepthRectifier::create(lens));
  EXPECT_LE(rectifier.camera().horizontalFov, 2.2689281);
  std::vector<std::uint16_t> made;
  rectifier.apply(std::vector<std::uint16_t>(40000, 1000), made);
  EXPECT_EQ(made.front(), 0);
  EXPECT_EQ(made[made.size() / 2 + rectifier.camera().width / 2], 1000);
  lens.distortion[0] = -5.0;
  EXPECT_TRUE(test::has(DepthRectifier::create(lens).error().message, "folds"));
}

TEST(UsualLens, EachSizeIsUsable) {
  EXPECT_NEAR(valueOf(parseDepthLens("640x480")).focalX, DepthCamera().focalX(), 1.0);
  EXPECT_EQ(valueOf(parseDepthLens("fov=60x45", 640, 480)).height, 480);
  for (const char* turned : {"fov=400x65", "fov=75x425", "fov=-60x45", "fov=180x45"}) {
    EXPECT_FALSE(parseDepthLens(turned, 640, 480).ok()) << turned;
  }
  EXPECT_FALSE(parseDepthLens("320x240", 640, 480));
  EXPECT_FALSE(usualLens(123, 456));
}

TEST(DepthUnit, AWrongOneIsFoundOut) {
  const DepthLens lens = DepthLens::pinhole(40, 30, 1.0, 0.8);
  std::vector<std::uint16_t> raw(1200, 2500);
  EXPECT_TRUE(checkDepthUnit(lens, raw));
  for (const double unit : {0.00001, 0.01}) {
    DepthLens other = lens;
    other.metresPerUnit = unit;
    EXPECT_FALSE(checkDepthUnit(other, raw)) << unit;
  }
  std::fill(raw.begin(), raw.end() - 5, std::uint16_t{0});
  DepthLens other = lens;
  other.metresPerUnit = 0.01;
  EXPECT_TRUE(checkDepthUnit(other, raw)) << "too few pixels to tell";
}

}  // namespace
}  // namespace lorica
