#include "viewer/window/orbit_camera.h"

#include "geometry/random_numbers.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

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
