#include "collision/world.h"
#include "tests/collision/mesh_props.h"
#include "tests/collision/parts.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

using test::at;

constexpr double kFrame = 1.0 / 60.0;

Prop ball(double radius, const Vec3& place, double mass = 1.0) {
  Prop prop;
  prop.shape = PropShape::kSphere;
  prop.halfExtents = Vec3::Constant(radius);
  prop.mass = mass;
  prop.worldFromProp = Eigen::Translation3d(place);
  return prop;
}

void run(World& world, double seconds) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds / kFrame)); ++i) world.step({}, kFrame);
}

Vec3 placeOf(const World& world, int prop) {
  return world.props()[static_cast<std::size_t>(prop)].worldFromProp.translation();
}

TEST(WorldPick, FindsTheNearestPropWhereTheRayEntersIt) {
  World world;
  world.addProp(ball(0.2, Vec3(0, 1, 5)));
  world.addProp(ball(0.2, Vec3(0, 1, 3)));
  const std::optional<PropPick> pick = world.pick({Vec3(0, 1, 0), Vec3(0, 0, 7)});
  ASSERT_TRUE(pick.has_value());
  EXPECT_EQ(pick->prop, 1);
  EXPECT_NEAR(pick->distance, 2.8, 1e-3);
  EXPECT_TRUE(pick->place.isApprox(Vec3(0, 1, 2.8), 1e-3)) << pick->place.transpose();
}

TEST(WorldPick, NothingIsFoundBesideThroughTheFloorOrAlongNoRay) {
  World world;
  world.addProp(ball(0.2, Vec3(0, 1, 3)));
  EXPECT_FALSE(world.pick({Vec3(0.3, 1, 0), Vec3::UnitZ()}).has_value());
  EXPECT_FALSE(world.pick({Vec3(0, -1, 3), Vec3::UnitY()}).has_value() &&
               world.pick({Vec3(0, -1, 3), Vec3::UnitY()})->distance < 1.5);
  EXPECT_FALSE(world.pick({Vec3(0, 1, 0), Vec3::Zero()}).has_value());
  EXPECT_FALSE(world.pick({Vec3(0, 1, 0), Vec3(0, 0, std::numeric_limits<double>::quiet_NaN())}).has_value());
  // From above at a ball below the floor's surface there is only floor.
  World sunk;
  sunk.addProp(ball(0.2, Vec3(0, -5, 0)));
  EXPECT_FALSE(sunk.pick({Vec3(0, 2, 0), -Vec3::UnitY()}).has_value());
}

TEST(WorldPick, SeesThroughAHoleAndPastTheAvatar) {
  World world;
  Prop frame = test::propOfFrame(0.3, 0.05);
  frame.worldFromProp = at(0, 1, 2) * Eigen::AngleAxisd(1.5707963, Vec3::UnitX());
  world.addProp(frame);
  world.addProp(ball(0.2, Vec3(0, 1, 4)));
  const std::array<LivePart, 1> avatar = {test::makeBoxPart(Vec3(0.3, 0.3, 0.3), at(0, 1, 1))};
  world.step(avatar, 0.0);
  const std::optional<PropPick> through = world.pick({Vec3(0, 1, 0), Vec3::UnitZ()});
  ASSERT_TRUE(through.has_value());
  EXPECT_EQ(through->prop, 1);
  const std::optional<PropPick> bar = world.pick({Vec3(0.175, 1, 0), Vec3::UnitZ()});
  ASSERT_TRUE(bar.has_value());
  EXPECT_EQ(bar->prop, 0);
}

TEST(WorldGrab, LiftsAPropToThePlaceAndLetsItFall) {
  World world;
  world.addProp(ball(0.1, Vec3(0, 0.1, 0), 2.0));
  run(world, 1.0);  // asleep
  ASSERT_TRUE(world.grab(0, Vec3(0, 0.2, 0)));
  world.moveGrab(Vec3(0.5, 1.2, 0));
  run(world, 2.0);
  ASSERT_TRUE(world.held().has_value());
  EXPECT_EQ(world.held()->prop, 0);
  EXPECT_LT((world.held()->place - Vec3(0.5, 1.2, 0)).norm(), 0.03) << world.held()->place.transpose();
  EXPECT_NEAR((placeOf(world, 0) - world.held()->place).norm(), 0.1, 0.005);
  world.release();
  EXPECT_FALSE(world.held().has_value());
  run(world, 2.0);
  EXPECT_NEAR(placeOf(world, 0).y(), 0.1, 0.005);
}

TEST(WorldGrab, OnlyWhatIsThereAndMovesCanBeHeld) {
  World world;
  world.addProp(ball(0.1, Vec3(0, 0.1, 0), 0.0));
  world.addProp(ball(0.1, Vec3(2, 0.1, 0)));
  EXPECT_FALSE(world.grab(0, Vec3(0, 0.1, 0)));
  EXPECT_FALSE(world.grab(1, Vec3(5, 0.1, 0)));
  EXPECT_FALSE(world.grab(2, Vec3(0, 0.1, 0)));
  EXPECT_FALSE(world.grab(-1, Vec3(0, 0.1, 0)));
  EXPECT_FALSE(world.grab(1, Vec3::Constant(std::numeric_limits<double>::infinity())));
  EXPECT_FALSE(world.held().has_value());
  world.moveGrab(Vec3(1, 1, 1));
  world.release();
  EXPECT_TRUE(world.grab(1, Vec3(2, 0.2, 0)));
}

TEST(WorldGrab, ItsForceIsBounded) {
  World world;
  world.addProp(ball(0.3, Vec3(0, 0.3, 0), 50.0));
  world.addProp(ball(0.3, Vec3(2, 0.3, 0), 80.0));
  ASSERT_TRUE(world.grab(0, Vec3(0, 0.6, 0)));
  world.moveGrab(Vec3(0, 1.5, 0));
  run(world, 3.0);
  EXPECT_GT(placeOf(world, 0).y(), 1.0);
  ASSERT_TRUE(world.grab(1, Vec3(2, 0.6, 0)));
  world.moveGrab(Vec3(2, 1.5, 0));
  run(world, 3.0);
  EXPECT_LT(placeOf(world, 1).y(), 0.31);
}

TEST(WorldGrab, AFarTargetHurlsNothing) {
  World world;
  world.addProp(ball(0.1, Vec3(0, 1, 0), 0.5));
  Prop wall;
  wall.halfExtents = Vec3(0.05, 2, 2);
  wall.mass = 0.0;
  wall.worldFromProp = at(1, 2, 0);
  world.addProp(wall);
  ASSERT_TRUE(world.grab(0, Vec3(0, 1, 0)));
  world.moveGrab(Vec3(30, 1, 0));
  for (int i = 0; i < 120; ++i) {
    world.step({}, kFrame);
    EXPECT_LT(world.props()[0].velocity.norm(), 9.0);
    EXPECT_LT(placeOf(world, 0).x(), 0.87);
  }
}

TEST(WorldThrow, TheOldestThrownComesBackAsTheNext) {
  World world;
  world.addProp(ball(0.2, Vec3(5, 0.2, 0)));
  for (int i = 0; i < World::kMostThrown; ++i) {
    EXPECT_EQ(world.throwProp(ball(0.05, Vec3(-4.0 + 0.125 * i, 0.05, 0))), i + 1);
  }
  run(world, 0.5);
  Prop next = ball(0.1, Vec3(0, 3, 2));
  next.velocity = Vec3(0, 0, 4);
  EXPECT_EQ(world.throwProp(next), 1);
  EXPECT_EQ(std::ssize(world.props()), World::kMostThrown + 1);
  EXPECT_EQ(world.props()[1].halfExtents.x(), 0.1);
  world.step({}, kFrame);
  EXPECT_NEAR(placeOf(world, 1).z(), 2 + 4 * kFrame, 1e-3);
  EXPECT_EQ(world.throwProp(next), 2);
  EXPECT_NEAR(placeOf(world, 0).x(), 5.0, 1e-3);
}

TEST(WorldThrow, WhatLeanedOnAThrownPropFallsWhenItIsTakenAway) {
  World world;
  Prop support = ball(0.2, Vec3(0, 0.1, 0));
  support.shape = PropShape::kBox;
  support.halfExtents = Vec3(0.2, 0.1, 0.2);
  world.throwProp(support);
  Prop box = support;
  box.worldFromProp = at(0, 0.3, 0);
  const int carried = world.addProp(box);
  run(world, 4.0);  // long enough to sleep
  EXPECT_NEAR(placeOf(world, carried).y(), 0.3, 0.005);
  for (int i = 0; i < World::kMostThrown; ++i) world.throwProp(ball(0.05, Vec3(4, 1.0 + i, 4)));
  run(world, 1.0);
  EXPECT_NEAR(placeOf(world, carried).y(), 0.1, 0.005);
}

TEST(WorldThrow, AHeldPropThatIsThrownAgainIsLetGo) {
  World world;
  for (int i = 0; i < World::kMostThrown; ++i) world.throwProp(ball(0.05, Vec3(0.2 * i, 0.05, 0)));
  ASSERT_TRUE(world.grab(0, Vec3(0, 0.1, 0)));
  EXPECT_EQ(world.throwProp(ball(0.05, Vec3(0, 1, 1))), 0);
  EXPECT_FALSE(world.held().has_value());
  run(world, 0.1);
}

TEST(WorldHands, TheSameHandsDoTheSameTwice) {
  const auto last = [] {
    World world;
    for (int i = 0; i < 10; ++i) world.addProp(ball(0.1, Vec3(0.15 * i, 0.5 + 0.1 * i, 0)));
    std::vector<Isometry3> places;
    for (int frame = 0; frame < 120; ++frame) {
      if (frame == 20) world.grab(3, placeOf(world, 3));
      if (frame > 20 && frame < 60) world.moveGrab(Vec3(0.02 * frame, 1.0, 0.01 * frame));
      if (frame == 60) world.release();
      if (frame % 3 == 0) {
        Prop thrown = ball(0.06, Vec3(0.5, 1, -3));
        thrown.velocity = Vec3(0, 2, 8);
        world.throwProp(thrown);
      }
      world.step({}, kFrame);
    }
    for (const Prop& prop : world.props()) places.push_back(prop.worldFromProp);
    return places;
  };
  const std::vector<Isometry3> first = last(), second = last();
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].matrix(), second[i].matrix()) << i;
}

}  // namespace
}  // namespace lorica
