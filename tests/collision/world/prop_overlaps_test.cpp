#include "collision/world/prop_overlaps.h"

#include "collision/world/world.h"
#include "session/scenes/scene_file.h"
#include "tests/collision/parts.h"
#include "tests/collision/world/mesh_props.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;

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

Prop boxAt(const Vec3& position, double half, double angle = 0.0) {
  Prop prop;
  prop.halfExtents = Vec3::Constant(half);
  prop.worldFromProp = Eigen::Translation3d(position) * Eigen::AngleAxisd(angle, Vec3::UnitY());
  return prop;
}

/// Whether a prop is inside an upright box part: tests a grid of points in the prop, without separating planes.
bool isCovered(const Prop& prop, const Vec3& moved, const Vec3& partAt, const Vec3& partHalf) {
  constexpr int kSteps = 12;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      for (int k = 0; k <= kSteps; ++k) {
        const Vec3 unit = Vec3(i, j, k) * (2.0 / kSteps) - Vec3::Ones();
        if (prop.shape == PropShape::kSphere && unit.norm() > 1.0) continue;
        const Vec3 position = prop.worldFromProp * Vec3(unit.cwiseProduct(prop.halfExtents)) + moved;
        if (((position - partAt).cwiseAbs().array() < partHalf.array()).all()) return true;
      }
    }
  }
  return false;
}

TEST(ResolveOverlaps, WhatIsClearStaysToTheBit) {
  const LivePart part = makeBoxPart(Vec3(0.3, 1.0, 0.3), at(0.0, 1.0, 0.0));
  const std::vector<Prop> props = {boxAt(Vec3(0.0, 0.1, 0.5), 0.1), boxAt(Vec3(0.0, 2.4, 0.0), 0.1)};
  for (const Vec3& move : resolveOverlaps(std::span(&part, 1), props)) EXPECT_TRUE(move.isZero());
  EXPECT_TRUE(resolveOverlaps({}, props)[0].isZero());
}

TEST(ResolveOverlaps, AStackGoesOutwardsAsOneAndWhatFallsGoesUp) {
  const Vec3 partAt(0.2, 1.5, 0.1), partHalf(0.6, 1.5, 0.8);
  const LivePart part = makeBoxPart(partHalf, at(partAt.x(), partAt.y(), partAt.z()));
  std::vector<Prop> props;
  for (int i = 0; i < 4; ++i) props.push_back(boxAt(Vec3(0.3, 0.1 + 0.2 * i, 0.7), 0.1, 0.05 * i));
  for (int i = 0; i < 3; ++i) {
    Prop falling = boxAt(Vec3(0.1, 2.2 + 0.4 * i, 0.0), 0.1, 0.3 * i);
    if (i % 2 == 0) falling.shape = PropShape::kSphere;
    props.push_back(falling);
  }
  const std::vector<Vec3> moves = resolveOverlaps(std::span(&part, 1), props);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(moves[i], moves[0]) << "of the stack, " << i;
  }
  for (std::size_t i = 4; i < 7; ++i) {
    EXPECT_EQ(moves[i], Vec3(0.0, moves[i].y(), 0.0));
    EXPECT_GT(moves[i].y(), 0.0) << "inside the part, whose top is at 3 m";
  }
  EXPECT_EQ(moves[0].y(), 0.0);
  EXPECT_GT(moves[0].z(), 0.2);
  EXPECT_GT(moves[0].normalized().dot(Vec3(0.1, 0.0, 0.6).normalized()), 0.999) << "away from the part's centre";
  for (std::size_t i = 0; i < props.size(); ++i) {
    EXPECT_TRUE(isCovered(props[i], Vec3::Zero(), partAt, partHalf)) << i;
    EXPECT_FALSE(isCovered(props[i], moves[i], partAt, partHalf)) << i;
    for (std::size_t k = 4; k < i; ++k) {
      EXPECT_GT(
          std::abs(
              (props[i].worldFromProp.translation() + moves[i] - props[k].worldFromProp.translation() - moves[k]).y()),
          0.2)
          << i << " in " << k;
    }
  }
}

TEST(ResolveOverlaps, StaticBodiesAndFlatPartsAreIgnored) {
  LivePart flat = makeBoxPart(Vec3(0.3, 1.0, 0.3), at(0.0, 1.0, 0.0));
  const std::vector<Prop> props = {boxAt(Vec3(0.0, 0.1, 0.0), 0.1)};
  EXPECT_FALSE(resolveOverlaps(std::span(&flat, 1), props)[0].isZero());
  std::vector<Prop> isStatic = props;
  isStatic[0].mass = 0.0;
  EXPECT_TRUE(resolveOverlaps(std::span(&flat, 1), isStatic)[0].isZero());
  flat.shape.triangles.clear();
  EXPECT_TRUE(resolveOverlaps(std::span(&flat, 1), props)[0].isZero());
}

TEST(ResolveOverlaps, AWorldDoesItOnceAndOnlyWhereItIsAsked) {
  LivePart part = makeBoxPart(Vec3(0.5, 1.0, 0.5), at(0.0, 1.0, 0.0));
  for (const bool asked : {false, true}) {
    World::Settings settings;
    settings.resolvesOverlaps = asked;
    World world(settings);
    world.addProp(boxAt(Vec3(0.0, 0.1, 0.4), 0.1));
    world.step({}, 0.0);
    EXPECT_NEAR(world.props()[0].worldFromProp.translation().z(), 0.4, 1e-6) << "there is no avatar yet";
    world.step(std::span(&part, 1), 1.0 / 30.0);
    EXPECT_EQ(world.contacts().empty(), asked);
    if (!asked) continue;
    EXPECT_GT(world.props()[0].worldFromProp.translation().z(), 0.6);
    EXPECT_LT(world.props()[0].velocity.norm(), 0.05) << "moved without velocity";
    // Later overlaps are not resolved in this way.
    test::moveTo(part, at(0.0, 1.0, 0.2));
    world.step(std::span(&part, 1), 0.1);
    EXPECT_FALSE(world.contacts().empty());
  }
}

constexpr double kFrame = 1.0 / 60.0;

void run(World& world, double seconds) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds / kFrame)); ++i) world.step({}, kFrame);
}

TEST(WorldMesh, ABoxOfOneHullRestsAtItsHalfHeight) {
  for (const double half : {0.03, 0.1, 0.25}) {
    const std::array<Aabb, 1> box = {{{Vec3(-half, -half, -half), Vec3(half, half, half)}}};
    Prop prop = test::propOfBoxes(box);
    prop.worldFromProp = at(0, 1, 0);
    World world;
    world.addProp(prop);
    run(world, 3.0);
    EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), half, 0.002) << half;
    EXPECT_LT(world.props()[0].velocity.norm(), 0.02);
  }
}

TEST(WorldMesh, StartsWhereItIsPutThoughItsMassIsElsewhere) {
  Prop prop = test::propOfLShape(0.1);
  prop.worldFromProp = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized());
  World::Settings settings;
  settings.gravity = Vec3::Zero();
  World world(settings);
  world.addProp(prop);
  run(world, 0.1);
  EXPECT_TRUE(world.props()[0].worldFromProp.isApprox(prop.worldFromProp, 1e-6));
}

/// The period of small oscillations of a solid is 2 pi sqrt(I / (m g d)), which tests inertia and centre of mass.
TEST(WorldMesh, SwingsInThePeriodOfItsInertia) {
  // An L of three cubes in the plane x, y, suspended at its outer corner, the origin of this drawing.
  //   [ ]
  //   [ ][ ]
  const double s = 0.2, mass = 3.0, g = 9.81;
  const Vec3 center(5.0 / 6.0 * s, 5.0 / 6.0 * s, 0.5 * s);
  double inertia = 0.0;  // about the z axis through the corner (parallel axis theorem)
  for (const Vec3& cube : {Vec3(0.5, 0.5, 0.5), Vec3(1.5, 0.5, 0.5), Vec3(0.5, 1.5, 0.5)}) {
    inertia += mass / 3.0 * (s * s / 6.0 + s * s * cube.head<2>().squaredNorm());
  }
  const double arm = center.head<2>().norm();
  const double period = 2.0 * std::numbers::pi * std::sqrt(inertia / (mass * g * arm));

  Prop prop = test::propOfLShape(s);
  prop.mass = mass;
  // Turned so that the centre of mass is below the corner, except for a small angle.
  const double swing = 0.05;
  const double turn = -0.75 * std::numbers::pi + swing;
  const Vec3 pivot(0, 2, 0);
  const Vec3 cornerInProp(-s, -s, 0.0);
  prop.worldFromProp =
      Eigen::Translation3d(pivot) * Eigen::AngleAxisd(turn, Vec3::UnitZ()) * Eigen::Translation3d(-cornerInProp);
  World::Settings settings;
  settings.substepSeconds = 1.0 / 1000.0;
  World world(settings);
  world.addProp(prop);
  world.addLink(0, kWorldItself, pivot);

  // Time between two passes through the middle in the same direction, interpolated linearly between frames.
  double before = 0.0, firstPass = -1.0, lastPass = -1.0;
  int passes = 0;
  for (int frame = 0; frame < 60 * 6; ++frame) {
    world.step({}, kFrame);
    const Vec3 down = world.props()[0].worldFromProp * Vec3(center - Vec3(s, s, 0.5 * s)) - pivot;
    const double side = down.x();
    if (frame > 0 && before < 0.0 && side >= 0.0) {
      const double time = kFrame * (frame - side / (side - before));
      if (firstPass < 0.0) firstPass = time;
      lastPass = time;
      ++passes;
    }
    before = side;
  }
  ASSERT_GE(passes, 4);
  EXPECT_NEAR((lastPass - firstPass) / (passes - 1), period, 0.01 * period);
}

/// A hollow mesh lets a prop through that is thinner than its hole; its convex hull would not.
TEST(WorldMesh, AFrameFallsAroundAPost) {
  Prop post;
  post.shape = PropShape::kCylinder;
  post.halfExtents = Vec3(0.06, 0.4, 0.06);
  post.mass = 0.0;
  post.worldFromProp = at(0, 0.4, 0);
  Prop frame = test::propOfFrame(0.24, 0.06);
  frame.worldFromProp = at(0, 1.2, 0);
  World world;
  world.addProp(post);
  world.addProp(frame);
  run(world, 2.0);
  const Vec3 pose = world.props()[1].worldFromProp.translation();
  EXPECT_NEAR(pose.y(), 0.03, 0.005);
  EXPECT_LT(pose.head<1>().norm(), 0.2);
}

TEST(WorldMesh, AMovingPartPushesItAndIsReported) {
  Prop prop = test::propOfLShape(0.15);
  prop.worldFromProp = at(0, 0.15, 0);
  World::Settings settings;
  settings.gravity = Vec3::Zero();
  World world(settings);
  world.addProp(prop);
  std::array<LivePart, 1> part = {test::makeBoxPart(Vec3(0.05, 0.3, 0.3), at(-0.5, 0.15, 0))};
  double impulse = 0.0;
  for (int i = 1; i <= 30; ++i) {
    test::moveTo(part[0], at(-0.5 + 2.0 * kFrame * i, 0.15, 0));
    world.step(part, kFrame);
    for (const Contact& contact : world.contacts()) {
      EXPECT_EQ(contact.prop, 0);
      EXPECT_EQ(contact.bone, kNoJoint);
      EXPECT_GT(contact.normal.x(), 0.5);
      impulse += contact.impulse;
    }
  }
  EXPECT_GT(world.props()[0].velocity.x(), 1.9);
  EXPECT_GT(impulse, 1.5);
  // The part's face is at 0.55; nothing of the L is behind it.
  const double face = part[0].worldFromPart.translation().x() + 0.05;
  for (const ConvexHull& hull : prop.mesh->hulls) {
    for (const Vec3& v : hull.vertices) EXPECT_GT((world.props()[0].worldFromProp * v).x(), face - 0.01);
  }
}

TEST(WorldMesh, AKickAcrossAFrameDoesNotPassThrough) {
  Prop prop = test::propOfLShape(0.08);
  prop.worldFromProp = at(0, 0.5, 0);
  World::Settings settings;
  settings.gravity = Vec3::Zero();
  World world(settings);
  world.addProp(prop);
  std::array<LivePart, 1> part = {test::makeBoxPart(Vec3(0.03, 0.1, 0.1), at(-0.4, 0.5, 0))};
  for (int i = 0; i < 2; ++i) {  // 0.4 m per frame: 12 m/s at 30 frames per second
    test::moveTo(part[0], at(-0.4 + 0.4 * (i + 1), 0.5, 0));
    world.step(part, 1.0 / 30.0);
  }
  EXPECT_GT(world.props()[0].velocity.x(), 8.0);
}

TEST(WorldMesh, StacksAndScattersTheSameTwice) {
  const auto last = [] {
    World world;
    for (int i = 0; i < 6; ++i) {
      Prop prop = i % 2 == 0 ? test::propOfLShape(0.1) : test::propOfFrame(0.2, 0.05);
      prop.worldFromProp = Eigen::Translation3d(0.02 * i, 0.3 + 0.35 * i, 0) * Eigen::AngleAxisd(i, Vec3::UnitX());
      world.addProp(prop);
    }
    run(world, 1.5);
    std::vector<Isometry3> poses;
    for (const Prop& prop : world.props()) poses.push_back(prop.worldFromProp);
    return poses;
  };
  const std::vector<Isometry3> first = last(), second = last();
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].matrix(), second[i].matrix()) << i;
}

}  // namespace
}  // namespace lorica
