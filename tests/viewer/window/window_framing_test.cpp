#include "tests/viewer/window/window_at_work.h"
#include "viewer/renderer/frame_setup.h"
#include "viewer/window/free_area.h"

#include <algorithm>
#include <array>
#include <random>

namespace lorica {
namespace {

TEST(FreeArea, IsAsLargeAsAnyRectangleThatTouchesNoPanel) {
  constexpr int kWidth = 12, kHeight = 9;
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<PixelArea> panels(static_cast<std::size_t>(round % 5));
    for (PixelArea& panel : panels) {
      panel.left = static_cast<float>(random() % kWidth);
      panel.top = static_cast<float>(random() % kHeight);
      panel.right = panel.left + 1.0f + static_cast<float>(random() % 4);
      panel.bottom = panel.top + 1.0f + static_cast<float>(random() % 4);
    }
    const auto isFree = [&](int left, int top, int right, int bottom) {
      return std::none_of(panels.begin(), panels.end(), [&](const PixelArea& p) {
        return p.left < right && p.right > left && p.top < bottom && p.bottom > top;
      });
    };
    std::array<int, 2> best{};  // shorter side and size, of all rectangles of whole pixels
    for (int left = 0; left < kWidth; ++left) {
      for (int right = left + 1; right <= kWidth; ++right) {
        for (int top = 0; top < kHeight; ++top) {
          for (int bottom = top + 1; bottom <= kHeight; ++bottom) {
            const int w = right - left, h = bottom - top;
            if (isFree(left, top, right, bottom)) best = std::max(best, {std::min(w, h), w * h});
          }
        }
      }
    }
    const PictureArea area = freeArea(kWidth, kHeight, panels);
    const double w = area.half.x() * kWidth, h = area.half.y() * kHeight;
    EXPECT_NEAR(std::min(w, h), best[0], 1e-4) << round;
    EXPECT_NEAR(w * h, best[1], 1e-3) << round;
    const double left = 0.5 * (1.0 + area.middle.x()) * kWidth - 0.5 * w;
    const double top = 0.5 * (1.0 - area.middle.y()) * kHeight - 0.5 * h;
    EXPECT_TRUE(isFree(static_cast<int>(std::lround(left)), static_cast<int>(std::lround(top)),
                       static_cast<int>(std::lround(left + w)), static_cast<int>(std::lround(top + h))))
        << round;
  }
}

/// Where a picture of a camera shows a point [pixels].
Eigen::Vector2d seen(const Vec3& point, const Camera& camera, int width, int height) {
  const FrameSetup setup = setUpFrame(Scene(), SceneOptions(), camera, width, height, 256);
  const Eigen::Vector4f clip = setup.uniforms.clipFromWorld * Eigen::Vector4f(point.cast<float>().homogeneous());
  return {0.5 * width * (1.0 + clip.x() / clip.w()), 0.5 * height * (1.0 - clip.y() / clip.w())};
}

TEST(FreeArea, TheDistanceToSeeABoxBringsItJustIntoTheArea) {
  Camera camera = test::frontCamera();
  camera.eye += Vec3(1.0, 0.7, 0.0);
  const Aabb box{{-0.4, 0.0, -0.3}, {0.9, 1.9, 0.5}};
  const PictureArea area{{0.2, -0.1}, {0.4, 0.6}};
  const double distance = distanceToSee(cornersOf(box), camera, area, 640.0 / 480.0);
  camera.eye = camera.target + distance * (camera.eye - camera.target).normalized();
  camera.targetAt = area.middle;
  double closest = 1e3;  // of a corner to the area's edge, inside it [pixels]
  for (const Vec3& corner : cornersOf(box)) {
    const Eigen::Vector2d at = seen(corner, camera, 640, 480);
    const double x = std::abs(at.x() - 0.5 * 640 * (1.0 + area.middle.x()));
    const double y = std::abs(at.y() - 0.5 * 480 * (1.0 - area.middle.y()));
    closest = std::min({closest, 0.5 * 640 * area.half.x() - x, 0.5 * 480 * area.half.y() - y});
  }
  EXPECT_NEAR(closest, 0.0, 0.01);
}

/// Follows a box at a place in windows of several sizes.
class WindowFraming : public WindowAtWork {
 protected:
  /// The pixels of panels within the followed box as it is seen.
  int hidden(int width, int height) {
    window->notice("");  // that a picture was saved
    const Image with = picture("shift+p"), without = picture();
    const Camera camera = window->camera();
    Eigen::Vector2d low(width, height), high(0, 0);
    for (const Vec3& corner : cornersOf(*values.followed)) {
      const Eigen::Vector2d at = seen(corner, camera, width, height);
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
    EXPECT_GE(low.minCoeff(), 0.0);
    EXPECT_LE(high.x(), width);
    EXPECT_LE(high.y(), height);
    EXPECT_GT((high - low).maxCoeff(), 0.25 * height) << "it is not far away";
    int count = 0;
    for (int y = std::max(static_cast<int>(low.y()), 0); y < std::min(static_cast<int>(high.y()), height); ++y) {
      for (int x = std::max(static_cast<int>(low.x()), 0); x < std::min(static_cast<int>(high.x()), width); ++x) {
        const std::size_t at = (static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)) * 4;
        for (std::size_t c = 0; c < 3; ++c) {
          if (std::abs(int{with.rgba[at + c]} - int{without.rgba[at + c]}) <= 24) continue;
          ++count;
          break;
        }
      }
    }
    return count;
  }
};

TEST_F(WindowFraming, NoPanelHidesWhomTheCameraFollows) {
  for (const auto& [width, height] : {std::pair(1280, 720), {480, 320}, {1600, 500}}) {
    open(width, height);
    values.treatable = true;
    values.focus = Vec3(40.0, 1.0, -25.0);  // far from where the camera looks first
    values.followed = Aabb{*values.focus - Vec3(0.8, 1.0, 0.6), *values.focus + Vec3(0.8, 0.9, 0.6)};
    frames(2);
    EXPECT_EQ(hidden(width, height), 0) << width << " x " << height;
    values.followed->min.x() -= 1.5;  // an arm's length, and a step
    frames(2);
    EXPECT_EQ(hidden(width, height), 0) << width << " x " << height;
    window.reset();
  }
}

TEST_F(WindowFraming, WhomTheCameraFollowsIsInTheMiddleOfTheFreeAreaAtEveryZoom) {
  for (const auto& [width, height] : {std::pair(1280, 720), {480, 320}}) {
    open(width, height);
    values.focus = Vec3(2.0, 0.9, -1.0);
    values.followed = Aabb{*values.focus - Vec3(0.4, 0.9, 0.3), *values.focus + Vec3(0.4, 0.9, 0.3)};
    frames(3);
    const Eigen::Vector2d at = seen(*values.focus, window->camera(), width, height);
    EXPECT_NEAR(at.x(), 0.5 * width, 1.0) << "the panels at both sides are equally wide";
    EXPECT_LT(std::abs(at.y() - 0.5 * height), 0.15 * height);
    for (int zoom = 0; zoom < 4; ++zoom) {
      send("mousemove --window %1 300 200 click 4 click 4 click 4");
      EXPECT_LT((seen(*values.focus, window->camera(), width, height) - at).norm(), 0.01);
    }
    window.reset();
  }
}

TEST_F(WindowFraming, TheUsersOwnZoomStays) {
  open(640, 480);
  values.focus = Vec3(0.0, 1.0, 0.0);
  values.followed = Aabb{{-3.0, 0.0, -3.0}, {3.0, 6.0, 3.0}};
  frames(2);
  const auto distance = [&] { return (window->camera().eye - window->camera().target).norm(); };
  const double whole = distance();
  send("mousemove --window %1 320 200 click 4");
  EXPECT_NEAR(distance(), 0.9 * whole, 1e-6) << "from what was seen";
  frames(3);
  EXPECT_NEAR(distance(), 0.9 * whole, 1e-6);
  send("key r");
  EXPECT_NEAR(distance(), whole, 0.01 * whole);
}

}  // namespace
}  // namespace lorica
