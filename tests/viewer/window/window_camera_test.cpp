#include "tests/viewer/window/window_at_work.h"

#include <utility>

namespace lorica {
namespace {

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
  const std::optional<Ray> clicked = window->takeRequests().clicked;
  ASSERT_TRUE(clicked.has_value());
  EXPECT_LT((clicked->direction - window->aim(0).ray.direction).norm(), 1e-9);
  send("mousemove --window %1 160 100 mousedown 1 mousemove --window %1 200 110 mouseup 1");
  EXPECT_FALSE(window->takeRequests().clicked.has_value()) << "it turned the camera";
  values.holds = 1;
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
