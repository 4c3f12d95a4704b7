#include "collision/world/prop_overlaps.h"

#include "session/scenes/scene_file.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

std::string errorOf(const std::string& content) {
  const Result<SceneFile> scene = parseScene(R"({"format": "lorica scene 1", )" + content + "}", "s.json");
  return scene ? "none" : scene.error().message;
}

Prop propAt(PropShape shape, const Vec3& halfExtents, const Vec3& position) {
  Prop prop;
  prop.shape = shape;
  prop.halfExtents = halfExtents;
  prop.worldFromProp.translation() = position;
  return prop;
}

/// Whether the centre of a small ball at a position is inside a prop.
bool isInside(const Prop& prop, const Vec3& position) {
  const std::vector<Prop> props = {prop, propAt(PropShape::kSphere, Vec3::Constant(1e-3), position)};
  const std::optional<PropOverlap> found = findPropInside(props);
  if (found) {
    EXPECT_EQ(found->inner, 1u);
    EXPECT_EQ(found->outer, 0u);
  }
  return found.has_value();
}

TEST(PropOverlaps, ShapesContainWhatTheirFormulasSay) {
  const Vec3 at(3.0, 1.0, -2.0), half(0.2, 0.5, 0.3);
  struct Case {
    PropShape shape;
    Vec3 inside, outside;  // of the centre
  };
  const std::vector<Case> cases = {
      {PropShape::kBox, {0.19, 0.49, 0.29}, {0.21, 0.0, 0.0}},
      {PropShape::kSphere, {0.11, 0.11, 0.11}, {0.12, 0.12, 0.12}},    // 0.1905 and 0.2078
      {PropShape::kCapsule, {0.0, 0.49, 0.0}, {0.15, 0.45, 0.0}},      // 0.2121 from the end of the axis
      {PropShape::kCylinder, {0.14, 0.49, 0.14}, {0.15, 0.0, 0.15}}};  // 0.198 and 0.2121
  for (const Case& c : cases) {
    Prop prop = propAt(c.shape, half, at);
    EXPECT_TRUE(isInside(prop, at + c.inside)) << static_cast<int>(c.shape);
    EXPECT_FALSE(isInside(prop, at + c.outside)) << static_cast<int>(c.shape);
    const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
    prop.worldFromProp.linear() = turn;
    EXPECT_TRUE(isInside(prop, at + turn * c.inside)) << static_cast<int>(c.shape);
    EXPECT_FALSE(isInside(prop, at + turn * c.outside)) << static_cast<int>(c.shape);
  }
}

TEST(PropOverlaps, StaticBodiesMayShareTheirPlace) {
  Prop fixed = propAt(PropShape::kBox, Vec3::Ones(), Vec3::Zero());
  fixed.mass = 0.0;
  Prop moving = fixed;
  moving.mass = 1.0;
  EXPECT_FALSE(findPropInside(std::vector<Prop>{fixed, fixed}));
  EXPECT_EQ(countNearPairs(std::vector<Prop>{fixed, fixed, fixed}), 0u);
  EXPECT_TRUE(findPropInside(std::vector<Prop>{fixed, moving}));
  EXPECT_EQ(countNearPairs(std::vector<Prop>{fixed, moving, fixed}), 2u);
}

TEST(PropOverlaps, TheFirstStaticBodyAroundAPointIsFound) {
  Prop moving = propAt(PropShape::kBox, Vec3::Ones(), Vec3::Zero());
  Prop fixed = propAt(PropShape::kSphere, Vec3::Constant(0.5), Vec3(1.0, 0.0, 0.0));
  fixed.mass = 0.0;
  const std::vector<Prop> props = {moving, fixed, fixed};
  EXPECT_EQ(findStaticAround(props, Vec3(0.8, 0.0, 0.0)), 1u);
  EXPECT_FALSE(findStaticAround(props, Vec3(0.0, 0.0, 0.0)));
  EXPECT_FALSE(findStaticAround(props, Vec3(1.6, 0.0, 0.0)));
}

TEST(PropOverlaps, ScenesWithPropsInsideEachOtherAreRefusedByName) {
  EXPECT_EQ(
      errorOf(R"("props": [{"shape": "box", "size": [1, 1, 1], "at": [0, 1, 0],
                     "repeat": {"count": 2000, "step": [0, 0, 0]}}])"),
      "s.json: the scene: found copy 2 of props[0] inside copy 1 of props[0], expected objects beside each other");
  EXPECT_EQ(errorOf(R"("props": [{"shape": "box", "size": [1, 1, 1], "at": [5, 1, 0]},
                     {"shape": "box", "size": [1, 1, 1], "at": [0, 1, 0], "fixed": true},
                     {"shape": "sphere", "radius": 0.1, "at": [0.4, 1, 0]}])"),
            "s.json: the scene: found props[2] inside props[1], expected objects beside each other");
  EXPECT_EQ(errorOf(R"("props": [{"shape": "sphere", "radius": 0.1, "at": [0, 1.9, 0]}],
                     "chains": [{"from": [0, 2, 0], "to": [0, 1, 0], "links": 5, "radius": 0.05}])"),
            "s.json: the scene: found copy 1 of chains[0] inside props[0], expected objects beside each other");
  EXPECT_EQ(errorOf(R"("props": [{"shape": "box", "size": [1, 1, 1], "at": [0, 1, 0],
                     "repeat": {"count": 40, "step": [0.9, 0, 0]}}])"),
            "none");
}

/// 2,000 crossed bars, turned so that no centre is inside another bar: 2 million pairs of boxes that overlap.
TEST(PropOverlaps, ThePairsOfASceneAreBounded) {
  const std::string bars =
      R"("props": [{"shape": "box", "size": [20, 0.01, 0.01], "at": [-5, 0, 0], "turn": [0, 45, 45],
                             "repeat": {"count": 2000, "step": [0.02, 0, 0]}}])";
  EXPECT_NE(errorOf(bars).find("expected at most 20000"), std::string::npos) << errorOf(bars);
}

}  // namespace
}  // namespace lorica
