#include "viewer/scene.h"

#include "geometry/random_numbers.h"
#include "viewer/orbit_camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

/// Linear sRGB to OKLab (B. Ottosson 2020), in which distances are perceptually uniform.
Vec3 oklab(const Vec3f& c) {
  const double l = std::cbrt(0.4122214708 * c.x() + 0.5363325363 * c.y() + 0.0514459929 * c.z());
  const double m = std::cbrt(0.2119034982 * c.x() + 0.6806995451 * c.y() + 0.1073969566 * c.z());
  const double s = std::cbrt(0.0883024619 * c.x() + 0.2817188376 * c.y() + 0.6299787005 * c.z());
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

TEST(PartColor, ThirtyTwoPartsCanBeDistinguished) {
  double nearest = 1.0;
  for (int i = 0; i < 32; ++i) {
    const Vec3f color = partColor(i);
    EXPECT_GE(color.minCoeff(), 0.0f);
    EXPECT_LE(color.maxCoeff(), 1.0f);
    for (int j = 0; j < i; ++j) nearest = std::min(nearest, (oklab(color) - oklab(partColor(j))).norm());
  }
  EXPECT_GT(nearest, 0.05);  // a just noticeable difference is about 0.02
}

TEST(PartColor, NeighboursInOrderDifferStrongly) {
  for (int i = 1; i < 64; ++i) EXPECT_GT((oklab(partColor(i)) - oklab(partColor(i - 1))).norm(), 0.12) << i;
}

TEST(PartColor, AnyIndexGivesAColor) {
  for (const int part : {-1, 1000000, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    const Vec3f color = partColor(part);
    EXPECT_TRUE(color.allFinite());
    EXPECT_GE(color.minCoeff(), 0.0f);
    EXPECT_LE(color.maxCoeff(), 1.0f);
  }
}

TEST(PartedSkin, LeavesOutCapsAndKeepsParts) {
  Decomposition decomposition;
  decomposition.parts.resize(2);
  decomposition.parts[0].triangles = {{0, 1, 2}, {2, 1, 3}};
  decomposition.parts[0].sourceTriangle = {7, -1};
  decomposition.parts[1].triangles = {{3, 4, 5}};
  decomposition.parts[1].sourceTriangle = {7};
  const PartedSkin skin = makePartedSkin(decomposition);
  EXPECT_EQ(skin.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(skin.partOfTriangle, (std::vector<PartIndex>{0, 1}));
}

TEST(OrbitCamera, StartsAndResetsWhereItWasPut) {
  const Camera start;
  OrbitCamera orbit(start);
  EXPECT_LT((orbit.camera().eye - start.eye).norm(), 1e-12);
  orbit.turn(1.0, 0.4);
  orbit.pan(0.3, -0.2);
  orbit.zoom(1.7);
  EXPECT_GT((orbit.camera().eye - start.eye).norm(), 0.5);
  orbit.reset();
  EXPECT_LT((orbit.camera().eye - start.eye).norm(), 1e-12);
  EXPECT_EQ(orbit.camera().target, start.target);
}

TEST(OrbitCamera, TurningKeepsTheDistanceAndStopsShortOfThePoles) {
  const Camera start;
  const double distance = (start.eye - start.target).norm();
  OrbitCamera orbit(start);
  for (int i = 0; i < 50; ++i) {
    orbit.turn(0.37, 0.2);
    const Camera now = orbit.camera();
    EXPECT_NEAR((now.eye - now.target).norm(), distance, 1e-9);
    const Vec3 offset = now.eye - now.target;
    EXPECT_GT(std::hypot(offset.x(), offset.z()), 0.01 * distance);
  }
  EXPECT_GT(orbit.camera().eye.y(), start.target.y() + 0.9 * distance);
}

TEST(OrbitCamera, PanningByAPictureHeightMovesByTheSeenHeight) {
  Camera start;
  start.eye = {0, 1, 5};
  start.target = {0, 1, 0};
  OrbitCamera orbit(start);
  orbit.pan(1.0, 0.5);
  const double seen = 2.0 * 5.0 * std::tan(0.5 * start.verticalFov);
  EXPECT_NEAR(orbit.camera().target.x(), seen, 1e-9);
  EXPECT_NEAR(orbit.camera().target.y(), 1.0 + 0.5 * seen, 1e-9);
}

TEST(OrbitCamera, TheUserCannotGoBelowTheFloor) {
  OrbitCamera orbit;
  RandomNumbers random(5);
  for (int i = 0; i < 2000; ++i) {
    const double amount = random.between(-1.0, 1.0);
    const double other = random.between(-1.0, 1.0);
    if (i % 3 == 0) orbit.turn(amount, other);
    if (i % 3 == 1) orbit.pan(amount, other);
    if (i % 3 == 2) orbit.zoom(std::exp(0.5 * amount));
    EXPECT_GE(orbit.camera().eye.y(), 0.05 - 1e-9);
    EXPECT_GE(orbit.camera().target.y(), 0.0);
  }
  orbit.reset();
  orbit.turn(0.0, -3.0);
  EXPECT_NEAR(orbit.camera().eye.y(), 0.05, 1e-9);
}

TEST(OrbitCamera, ZoomStaysWithinReach) {
  OrbitCamera orbit;
  for (int i = 0; i < 200; ++i) orbit.zoom(0.9);
  EXPECT_NEAR((orbit.camera().eye - orbit.camera().target).norm(), 0.2, 1e-9);
  for (int i = 0; i < 200; ++i) orbit.zoom(1.2);
  EXPECT_NEAR((orbit.camera().eye - orbit.camera().target).norm(), 60.0, 1e-9);
}

}  // namespace
}  // namespace lorica
