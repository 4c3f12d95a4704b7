#include "collision/world/world.h"

#include "tests/collision/parts.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

using test::at;

constexpr double kFrame = 1.0 / 30.0;

Prop box(const Vec3& halfExtents, const Isometry3& pose, const Vec3& velocity = Vec3::Zero()) {
  Prop prop;
  prop.halfExtents = halfExtents;
  prop.worldFromProp = pose;
  prop.velocity = velocity;
  return prop;
}

Prop ball(double radius, const Isometry3& pose, const Vec3& velocity = Vec3::Zero()) {
  Prop prop = box(Vec3::Constant(radius), pose, velocity);
  prop.shape = PropShape::kSphere;
  return prop;
}

World weightless() {
  World::Settings settings;
  settings.gravity = Vec3::Zero();
  return World(settings);
}

void run(World& world, double seconds) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds / kFrame)); ++i) world.step({}, kFrame);
}

TEST(WorldProps, FreeFallFollowsTheParabola) {
  World world;
  world.addProp(box(Vec3::Constant(0.1), at(0, 20, 0), Vec3(1, 0, 0)));
  run(world, 1.0);
  const Prop& prop = world.props()[0];
  // Symplectic Euler is ahead of the parabola by g t h / 2.
  EXPECT_NEAR(prop.worldFromProp.translation().y(), 20 - 0.5 * 9.81 - 0.5 * 9.81 / 240, 1e-3);
  EXPECT_NEAR(prop.worldFromProp.translation().x(), 1.0, 1e-3);
  EXPECT_NEAR(prop.velocity.y(), -9.81, 1e-3);
}

TEST(WorldProps, BoxesAndBallsRestOnTheFloorAtTheirHalfHeight) {
  for (double half : {0.03, 0.1, 0.25}) {
    World world;
    world.addProp(box(Vec3(half, 0.5 * half, half), at(0, 1, 0)));
    world.addProp(ball(half, at(2, 1, 0)));
    run(world, 4.0);
    EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), 0.5 * half, 0.002) << half;
    EXPECT_NEAR(world.props()[1].worldFromProp.translation().y(), half, 0.002) << half;
    EXPECT_LT(world.props()[0].velocity.norm(), 0.02);
  }
}

/// Forty boxes of 10 cm thickness, thrown down in all orientations.
World hail(double slowest, double fastest) {
  World world;
  std::mt19937_64 random(21);
  for (int i = 0; i < 40; ++i) {
    Isometry3 pose = at(2.0 * (i % 8) - 8.0, 3.0, 2.0 * (i / 8) - 5.0);
    pose.rotate(test::uniformRotation(random));
    const double speed = slowest + (fastest - slowest) * i / 39.0;
    world.addProp(box(Vec3(0.1, 0.05, 0.15), pose, Vec3(test::uniform(random, -3, 3), -speed, 0)));
  }
  return world;
}

TEST(WorldProps, TheMiddleOfAThrownBoxStaysAboveTheFloor) {
  World world = hail(1.0, 12.0);
  for (int frame = 0; frame < 150; ++frame) {
    world.step({}, kFrame);
    for (const Prop& prop : world.props()) {
      EXPECT_GT(prop.worldFromProp.translation().y(), 0.0) << "frame " << frame;
    }
  }
}

TEST(WorldProps, NothingGoesThroughTheFloorHoweverFast) {
  // At 130 m/s a box moves half a metre in a substep, so it is in the floor for one or two; it must come back.
  World world = hail(20.0, 130.0);
  run(world, 15.0);
  for (const Prop& prop : world.props()) {
    ASSERT_TRUE(prop.worldFromProp.matrix().allFinite());
    EXPECT_GT(prop.worldFromProp.translation().y(), 0.047);
    EXPECT_LT(prop.worldFromProp.translation().y(), 0.16);
  }
}

TEST(WorldProps, CollisionsKeepMomentumAndMakeNoEnergy) {
  std::mt19937_64 random(22);
  for (int i = 0; i < 20; ++i) {
    World world = weightless();
    Prop a = i % 2 == 0 ? ball(0.1, at(-0.5, 5, 0)) : box(Vec3::Constant(0.1), at(-0.5, 5, 0));
    Prop b = i % 3 == 0 ? ball(0.15, at(0.5, 5.03, 0.02)) : box(Vec3(0.1, 0.2, 0.1), at(0.5, 5.03, 0.02));
    a.mass = test::uniform(random, 0.2, 3.0);
    b.mass = test::uniform(random, 0.2, 3.0);
    a.velocity = Vec3(test::uniform(random, 1, 5), 0, 0);
    b.velocity = Vec3(-test::uniform(random, 1, 5), 0, 0);
    a.restitution = b.restitution = test::uniform(random, 0, 1);
    const Vec3 momentum = a.mass * a.velocity + b.mass * b.velocity;
    const double energy = 0.5 * (a.mass * a.velocity.squaredNorm() + b.mass * b.velocity.squaredNorm());
    world.addProp(a);
    world.addProp(b);
    run(world, 1.0);
    const Vec3 va = world.props()[0].velocity;
    const Vec3 vb = world.props()[1].velocity;
    EXPECT_LT(va.x(), vb.x()) << "they met and separated, case " << i;
    EXPECT_LT((a.mass * va + b.mass * vb - momentum).norm(), 1e-4) << "case " << i;
    EXPECT_LE(0.5 * (a.mass * va.squaredNorm() + b.mass * vb.squaredNorm()), energy * 1.001) << "case " << i;
  }
}

TEST(WorldProps, AStackStands) {
  World world;
  for (int i = 0; i < 10; ++i) world.addProp(box(Vec3::Constant(0.1), at(0.01 * (i % 2), 0.1 + 0.2 * i, 0)));
  run(world, 20.0);
  for (int i = 0; i < 10; ++i) {
    const Vec3 pose = world.props()[i].worldFromProp.translation();
    EXPECT_LT((pose - Vec3(0.01 * (i % 2), 0.1 + 0.2 * i, 0)).norm(), 0.006) << "box " << i;
  }
}

TEST(WorldProps, NoTimeMovesNothing) {
  World world;
  world.addProp(box(Vec3::Constant(0.1), at(0, 2, 0), Vec3(1, 2, 3)));
  world.step({}, 0.0);
  EXPECT_LT((world.props()[0].worldFromProp.translation() - Vec3(0, 2, 0)).norm(), 1e-6);
  EXPECT_LT((world.props()[0].velocity - Vec3(1, 2, 3)).norm(), 1e-6);
}

TEST(WorldProps, AWorldCanBeMoved) {
  World first;
  first.addProp(box(Vec3::Constant(0.1), at(0, 1, 0)));
  World second = std::move(first);
  run(second, 1.0);
  EXPECT_EQ(second.props().size(), 1u);
  EXPECT_LT(second.props()[0].worldFromProp.translation().y(), 0.2);
}

Prop shaped(PropShape shape, double radius, double halfHeight, const Isometry3& pose) {
  Prop prop = box(Vec3(radius, halfHeight, radius), pose);
  prop.shape = shape;
  return prop;
}

TEST(WorldProps, CapsulesAndCylindersRestOnTheirSidesAndEnds) {
  World world;
  Isometry3 lying = at(0, 0.5, 0);
  lying.rotate(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitZ()));
  world.addProp(shaped(PropShape::kCapsule, 0.08, 0.3, lying));
  lying.translation().x() = 2.0;
  world.addProp(shaped(PropShape::kCylinder, 0.08, 0.3, lying));
  world.addProp(shaped(PropShape::kCylinder, 0.2, 0.1, at(4, 0.5, 0)));
  run(world, 4.0);
  EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), 0.08, 0.002);
  EXPECT_NEAR(world.props()[1].worldFromProp.translation().y(), 0.08, 0.002);
  EXPECT_NEAR(world.props()[2].worldFromProp.translation().y(), 0.1, 0.002);
}

TEST(WorldProps, StaticBodiesStayAndCarryProps) {
  World world;
  Prop table = box(Vec3(0.5, 0.02, 0.5), at(0, 0.7, 0));
  table.mass = 0.0;
  world.addProp(table);
  world.addProp(box(Vec3::Constant(0.1), at(0, 1.0, 0)));
  run(world, 4.0);
  EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), 0.7, 1e-6);
  EXPECT_NEAR(world.props()[1].worldFromProp.translation().y(), 0.82, 0.002);
}

TEST(WorldProps, ARodSwingsAsFastAsItsLengthSays) {
  World world;
  // A thin rod of 1 m length, suspended at one end and deflected by 0.1 rad.
  const Vec3 pivot(0, 3, 0);
  Isometry3 pose = Isometry3(Eigen::Translation3d(pivot)) * Eigen::AngleAxisd(0.1, Vec3::UnitZ());
  pose.translate(Vec3(0, -0.5, 0));
  world.addProp(shaped(PropShape::kCapsule, 0.01, 0.5, pose));
  world.addLink(0, kWorldItself, pivot);
  double previous = pose.translation().x();
  ASSERT_GT(previous, 0.0);
  std::vector<double> crossings;  // downwards through the middle
  for (int i = 0; i < 400; ++i) {
    world.step({}, 1.0 / 120.0);
    const Isometry3& now = world.props()[0].worldFromProp;
    EXPECT_NEAR((now * Vec3(0, 0.5, 0) - pivot).norm(), 0.0, 0.005);
    const double x = now.translation().x();
    if (previous > 0.0 && x <= 0.0) crossings.push_back((i + previous / (previous - x)) / 120.0);
    previous = x;
  }
  ASSERT_GE(crossings.size(), 2u);
  const double truth = 2.0 * EIGEN_PI * std::sqrt(2.0 * 1.0 / (3.0 * 9.81));
  EXPECT_NEAR(crossings[1] - crossings[0], truth, 0.02 * truth);
}

TEST(WorldProps, WithoutAFloorThingsFallOn) {
  World::Settings settings;
  settings.floor = false;
  World world(settings);
  world.addProp(ball(0.1, at(0, 0.5, 0)));
  run(world, 1.0);
  EXPECT_LT(world.props()[0].worldFromProp.translation().y(), -3.0);
}

}  // namespace
}  // namespace lorica
