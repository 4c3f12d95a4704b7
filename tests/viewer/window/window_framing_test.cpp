#include "geometry/random_numbers.h"
#include "tests/viewer/window/window_at_work.h"
#include "viewer/renderer/frame_setup.h"
#include "viewer/renderer/picture_area.h"
#include "viewer/window/orbit_camera.h"
#include "viewer/window/quality_choice.h"
#include "viewer/window/time_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

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

TEST_F(WindowAtWork, TheCameraMovesWithTheFocusUnlessToldNotTo) {
  open(320, 240);
  const auto looksAt = [&](const Vec3& point) { return (window->camera().target - point).norm() < 1e-9; };
  const Vec3 back = window->camera().eye - window->camera().target;
  values.focus = Vec3(0.5, 1.0, 0.0);
  frames(2);
  EXPECT_TRUE(looksAt(*values.focus));
  values.focus = Vec3(1.5, 1.4, -0.5);
  frames(2);
  EXPECT_TRUE(looksAt(*values.focus));
  EXPECT_LT((window->camera().eye - window->camera().target - back).norm(), 1e-9) << "from the same side";
  send("key f");
  const Vec3 before = *values.focus;
  values.focus = Vec3(3.0, 1.0, 0.0);
  frames(2);
  EXPECT_TRUE(looksAt(before)) << "free";
  send("key f");
  EXPECT_TRUE(looksAt(*values.focus));
}

TEST_F(WindowAtWork, KeysLookFromTheFrontTheSideTheBackAndAbove) {
  open(320, 240);
  const std::pair<const char*, Vec3> views[] = {
      {"F2", Vec3::UnitZ()}, {"F3", Vec3::UnitX()}, {"F4", -Vec3::UnitZ()}, {"F5", Vec3::UnitY()}};
  for (const auto& [key, from] : views) {
    send(std::string("key ") + key);
    const Camera camera = window->camera();
    EXPECT_GT((camera.eye - camera.target).normalized().dot(from), 0.99) << key;
    EXPECT_EQ(camera.target, test::frontCamera().target);
  }
  values.facing = 1.0;
  frames(1);
  send("key F2");
  const Vec3 back = window->camera().eye - window->camera().target;
  EXPECT_NEAR(std::atan2(back.x(), back.z()), 1.0, 1e-9) << "of the avatar";
}

TEST_F(WindowAtWork, FromTheFrontNothingHidesTheAvatar) {
  box.props[0].worldFromProp.translation() = Vec3(0.0, 1.0, 1.2);
  box.props[0].halfExtents.setConstant(0.2);
  box.props[0].color = Vec3f(0.0f, 0.0f, 1.0f);
  box.scene.contacts = {};
  open(320, 240);
  values.followed = boundsOf(box.mesh.vertices);
  values.focus = values.followed->center();
  frames(2);
  send("key 2");  // without hulls
  const auto blue = [&] {
    const Image image = picture();
    int count = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      count += image.rgba[i + 2] > 80 && image.rgba[i] < image.rgba[i + 2] / 2 ? 1 : 0;
    }
    return count;
  };
  const int solid = blue();
  EXPECT_GT(solid, 500);
  send("key F2");
  EXPECT_LT(blue(), solid / 2);
  send("mousemove --window %1 160 150 mousedown 1 mousemove --window %1 163 150 mouseup 1");
  EXPECT_GT(blue(), solid * 3 / 4) << "as it is, once the camera turns";
}

TEST_F(WindowAtWork, AClickIsAPressThatDoesNotMove) {
  open(320, 240);
  send("mousemove --window %1 160 100 click 1");
  const std::optional<Change> clicked = changeOf(ControlId::kClick);
  ASSERT_TRUE(clicked.has_value());
  EXPECT_LT((clicked->ray.direction - window->aim(0).ray.direction).norm(), 1e-9);
  send("mousemove --window %1 160 100 mousedown 1 mousemove --window %1 200 110 mouseup 1");
  EXPECT_FALSE(changeOf(ControlId::kClick).has_value()) << "it turned the camera";
  values.holds = 1;
  send("mousemove --window %1 160 100 click 1");
  EXPECT_FALSE(changeOf(ControlId::kClick).has_value()) << "it held a prop";
}

TEST_F(WindowAtWork, ControlPlusAndMinusChangeTheSizeOfText) {
  open(640, 480);
  const Image usual = picture("shift+p");
  send("key ctrl+equal ctrl+equal");
  EXPECT_EQ(window->choices().scale, 1.25 * 1.25);
  EXPECT_EQ(window->choices().speedFactor(), 1.0) << "without control they change the speed";
  EXPECT_GT(differingPixels(usual, picture("shift+p"), 24), 3000);
  send("key ctrl+0");
  EXPECT_EQ(window->choices().scale, 1.0);
  send("key ctrl+minus ctrl+minus ctrl+minus ctrl+minus ctrl+minus");
  EXPECT_EQ(window->choices().scale, kSmallestScale);
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

TEST(TimeGraph, KeepsTheLastFramesInOrder) {
  TimeGraph graph;
  EXPECT_EQ(graph.frameCount(), 0);
  EXPECT_EQ(graph.mean(0), 0.0);
  EXPECT_EQ(graph.longest(), 0.0);
  const int count = 3 * TimeGraph::kFrames + 7;
  for (int f = 0; f < count; ++f) {
    const std::array stages = {TimedStage{"hulls", 1.0 * f}, TimedStage{"physics", 0.5}};
    graph.add(stages);
    ASSERT_EQ(graph.frameCount(), std::min(f + 1, TimeGraph::kFrames));
    ASSERT_EQ(graph.milliseconds(graph.frameCount() - 1, 0), f) << "the newest frame is the last one";
  }
  ASSERT_EQ(graph.stageCount(), 2);
  EXPECT_STREQ(graph.name(1), "physics");
  for (int f = 0; f < TimeGraph::kFrames; ++f) {
    ASSERT_EQ(graph.milliseconds(f, 0), count - TimeGraph::kFrames + f);
    ASSERT_EQ(graph.total(f), graph.milliseconds(f, 0) + 0.5);
  }
  EXPECT_EQ(graph.longest(), count - 0.5);
  EXPECT_EQ(graph.mean(0), count - 15.5) << "of the last 30";
}

/// Draws for some time at a speed that depends on the level. @return number of changes of the level
int run(QualityChoice& choice, double& now, double seconds, const std::array<double, 3>& secondsAPicture) {
  int changes = 0;
  for (const double end = now + seconds; now < end;) {
    const double took = secondsAPicture[choice.level()];
    now += std::max(took, 1.0 / 60.0);
    changes += choice.add(took, now) ? 1 : 0;
  }
  return changes;
}

TEST(QualityChoice, FastMachinesKeepTheBest) {
  QualityChoice choice(3);
  double now = 0.0;
  EXPECT_EQ(run(choice, now, 60.0, {0.001, 0.002, 0.004}), 0);
  EXPECT_EQ(choice.level(), 2);
}

TEST(QualityChoice, SlowMachinesEndAtTheLowest) {
  QualityChoice choice(3);
  double now = 0.0;
  EXPECT_EQ(run(choice, now, 60.0, {0.05, 0.1, 0.3}), 2);
  EXPECT_EQ(choice.level(), 0);
}

TEST(QualityChoice, InBetweenItIsCalm) {
  QualityChoice choice(3);
  double now = 0.0;
  EXPECT_EQ(run(choice, now, 120.0, {0.008, 0.02, 0.1}), 1) << "medium is fast enough, high is not";
  EXPECT_EQ(choice.level(), 1);
  // Low is fast enough, medium is not: it is tried again, but less and less often.
  EXPECT_LE(run(choice, now, 300.0, {0.005, 0.06, 0.1}), 16);
  EXPECT_GE(run(choice, now, 60.0, {0.001, 0.002, 0.004}), 1) << "and is raised again when drawing is fast";
}

TEST(QualityChoice, OneSlowPictureChangesNothing) {
  QualityChoice choice(3);
  double now = 0.0;
  run(choice, now, 2.0, {0.005, 0.005, 0.005});
  choice.add(0.3, now += 0.3);
  EXPECT_EQ(run(choice, now, 2.0, {0.005, 0.005, 0.005}), 0);
  EXPECT_EQ(choice.level(), 2);
}

}  // namespace
}  // namespace lorica
