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

}  // namespace
}  // namespace lorica
