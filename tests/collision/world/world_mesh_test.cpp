#include "collision/world/world.h"
#include "tests/collision/parts.h"
#include "tests/collision/world/mesh_props.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

using test::at;

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
