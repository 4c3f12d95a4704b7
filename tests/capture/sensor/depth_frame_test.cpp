#include "capture/sensor/depth_frame.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

TEST(DepthCamera, TheImagesEdgesLieAtHalfTheFieldOfView) {
  const DepthCamera camera;
  const Vec3 left = camera.positionOf(-0.5, 239.5, 2.0);  // the left border of the left column
  EXPECT_NEAR(std::atan2(-left.x(), -left.z()), 0.5 * camera.horizontalFov, 1e-12);
  EXPECT_NEAR(left.y(), 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(left.z(), -2.0);
  const Vec3 top = camera.positionOf(319.5, -0.5, 2.0);
  EXPECT_NEAR(std::atan2(top.y(), -top.z()), 0.5 * camera.verticalFov, 1e-12);
}

TEST(DepthCamera, SeesAPositionWhereItWasComputedFrom) {
  const DepthCamera camera;
  for (const double column : {-0.5, 0.0, 100.25, 639.5}) {
    for (const double row : {0.0, 300.75}) {
      const Eigen::Vector2d point = camera.imagePointOf(camera.positionOf(column, row, 1.7));
      EXPECT_NEAR(point.x(), column + 0.5, 1e-10);
      EXPECT_NEAR(point.y(), row + 0.5, 1e-10);
    }
  }
}

}  // namespace
}  // namespace lorica
