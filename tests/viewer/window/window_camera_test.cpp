#include "tests/viewer/window/window_at_work.h"

#include <utility>

namespace lorica {
namespace {

TEST_F(WindowAtWork, TheCameraMovesWithTheFocusUnlessToldNotTo) {
  open(320, 240);
  const Camera before = window->camera();
  values.focus = Vec3(0.5, 1.0, 0.0);
  frames(2);
  EXPECT_EQ(window->camera().eye, before.eye) << "it starts where it is";
  values.focus = Vec3(1.5, 1.4, -0.5);
  frames(2);
  EXPECT_LT((window->camera().eye - before.eye - Vec3(1.0, 0.0, -0.5)).norm(), 1e-9) << "over the ground";
  EXPECT_LT((window->camera().target - before.target - Vec3(1.0, 0.0, -0.5)).norm(), 1e-9);
  send("key f");
  values.focus = Vec3(3.0, 1.0, 0.0);
  frames(2);
  EXPECT_LT((window->camera().eye - before.eye - Vec3(1.0, 0.0, -0.5)).norm(), 1e-9) << "free";
  send("key f");
  EXPECT_LT((window->camera().target - Vec3(3.0, before.target.y(), 0.0)).norm(), 1e-9) << "it looks at the focus";
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
}

TEST_F(WindowAtWork, AClickIsAPressThatDoesNotMove) {
  open(320, 240);
  send("mousemove --window %1 160 100 click 1");
  const std::optional<Ray> clicked = window->takeRequests().clicked;
  ASSERT_TRUE(clicked.has_value());
  EXPECT_LT((clicked->direction - window->pointer().direction).norm(), 1e-9);
  send("mousemove --window %1 160 100 mousedown 1 mousemove --window %1 200 110 mouseup 1");
  EXPECT_FALSE(window->takeRequests().clicked.has_value()) << "it turned the camera";
  values.holdsProp = true;
  send("mousemove --window %1 160 100 click 1");
  EXPECT_FALSE(window->takeRequests().clicked.has_value()) << "it held a prop";
}

TEST_F(WindowAtWork, ControlPlusAndMinusChangeTheSizeOfText) {
  open(640, 480);
  const Image usual = picture("shift+p");
  send("key ctrl+equal ctrl+equal");
  EXPECT_EQ(window->choices().scale, 1.25 * 1.25);
  EXPECT_EQ(window->choices().speed, 1.0) << "without control they change the speed";
  EXPECT_GT(differingPixels(usual, picture("shift+p"), 24), 3000);
  send("key ctrl+0");
  EXPECT_EQ(window->choices().scale, 1.0);
  send("key ctrl+minus ctrl+minus ctrl+minus ctrl+minus ctrl+minus");
  EXPECT_EQ(window->choices().scale, kSmallestScale);
}

}  // namespace
}  // namespace lorica
