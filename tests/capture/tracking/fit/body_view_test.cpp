#include "capture/tracking/fit/body_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lorica::fit {
namespace {

constexpr double kNear = 2000.0, kFar = 3500.0;  // someone before a wall [mm]

/// Somebody 160 pixels wide before a wall, with ramps of a width at both sides instead of steps [pixels].
BodyView viewOf(double ramp) {
  const DepthCamera camera;
  std::vector<std::uint16_t> depth;
  std::vector<std::uint8_t> labels;
  depth.reserve(static_cast<std::size_t>(camera.width) * camera.height);
  labels.reserve(depth.capacity());
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double outside = std::abs(x + 0.5 - 0.5 * camera.width) - 80.0;
      const double share = y < 100 || y >= 400 ? 1.0 : std::clamp(outside / ramp + 0.5, 0.0, 1.0);
      depth.push_back(static_cast<std::uint16_t>(kNear + share * (kFar - kNear)));
      labels.push_back(depth.back() < kFar - 100.0 ? 1 : 0);  // what is nearer than the wall is taken for the person
    }
  }
  BodyView view(camera);
  view.look(depth, labels, 1, Isometry3::Identity());
  return view;
}

float deepest(const BodyView& view) {
  float depth = 0.0F;
  for (const BodyView::Point& point : view.points()) depth = std::max(depth, -point.position.z());
  return depth;
}

TEST(BodyView, AllBlocksOfAPersonWithSharpEdgesArePoints) {
  const BodyView view = viewOf(1.0);
  EXPECT_FALSE(view.blurred());
  EXPECT_EQ(view.points().size(), 160U / 4 * (300 / 4));
  EXPECT_NEAR(deepest(view), 2.0, 1e-3);
}

TEST(BodyView, TheRampsOfBlurredEdgesAreNoPoints) {
  for (const double ramp : {10.0, 14.0, 18.0}) {
    const BodyView view = viewOf(ramp);
    EXPECT_TRUE(view.blurred()) << ramp;
    EXPECT_LT(deepest(view), 2.07) << ramp;
    EXPECT_GT(view.points().size(), 130U / 4 * (300 / 4)) << ramp;
  }
}

}  // namespace
}  // namespace lorica::fit
