#include "collision/world/world.h"
#include "tests/collision/parts.h"
#include "tests/collision/world/mesh_props.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace lorica {
namespace {

using test::at;

constexpr double kFrame = 1.0 / 60.0;

Prop ball(double radius, const Vec3& pose, double mass = 1.0) {
  Prop prop;
  prop.shape = PropShape::kSphere;
  prop.halfExtents = Vec3::Constant(radius);
  prop.mass = mass;
  prop.worldFromProp = Eigen::Translation3d(pose);
  return prop;
}

void run(World& world, double seconds) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds / kFrame)); ++i) world.step({}, kFrame);
}

Vec3 positionOf(const World& world, int prop) {
  return world.props()[prop].worldFromProp.translation();
}

TEST(WorldPick, FindsTheNearestPropWhereTheRayEntersIt) {
  World world;
  world.addProp(ball(0.2, Vec3(0, 1, 5)));
  world.addProp(ball(0.2, Vec3(0, 1, 3)));
  const std::optional<PropPick> pick = world.pick({Vec3(0, 1, 0), Vec3(0, 0, 7)});
  ASSERT_TRUE(pick.has_value());
  EXPECT_EQ(pick->prop, 1);
  EXPECT_NEAR(pick->distance, 2.8, 1e-3);
  EXPECT_TRUE(pick->position.isApprox(Vec3(0, 1, 2.8), 1e-3)) << pick->position.transpose();
}

TEST(WorldPick, NothingIsFoundBesideThroughTheFloorOrAlongNoRay) {
  World world;
  world.addProp(ball(0.2, Vec3(0, 1, 3)));
  EXPECT_FALSE(world.pick({Vec3(0.3, 1, 0), Vec3::UnitZ()}).has_value());
  EXPECT_FALSE(world.pick({Vec3(0, -1, 3), Vec3::UnitY()}).has_value() &&
               world.pick({Vec3(0, -1, 3), Vec3::UnitY()})->distance < 1.5);
  EXPECT_FALSE(world.pick({Vec3(0, 1, 0), Vec3::Zero()}).has_value());
  EXPECT_FALSE(world.pick({Vec3(0, 1, 0), Vec3(0, 0, std::numeric_limits<double>::quiet_NaN())}).has_value());
  // A ray from above to a ball below the floor hits only the floor.
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

TEST(WorldGrab, LiftsAPropToThePositionAndLetsItFall) {
  World world;
  world.addProp(ball(0.1, Vec3(0, 0.1, 0), 2.0));
  run(world, 1.0);  // asleep
  ASSERT_TRUE(world.grab(0, Vec3(0, 0.2, 0)));
  world.moveGrab(Vec3(0.5, 1.2, 0));
  run(world, 2.0);
  ASSERT_TRUE(world.held().has_value());
  EXPECT_EQ(world.held()->prop, 0);
  EXPECT_LT((world.held()->position - Vec3(0.5, 1.2, 0)).norm(), 0.03) << world.held()->position.transpose();
  EXPECT_NEAR((positionOf(world, 0) - world.held()->position).norm(), 0.1, 0.005);
  world.release();
  EXPECT_FALSE(world.held().has_value());
  run(world, 2.0);
  EXPECT_NEAR(positionOf(world, 0).y(), 0.1, 0.005);
}

TEST(WorldGrab, AThrownPropLeavesWithTheGivenVelocity) {
  World world;
  world.addProp(ball(0.1, Vec3(0, 1.0, 0), 2.0));
  ASSERT_TRUE(world.grab(0, Vec3(0, 1.1, 0)));
  world.moveGrab(Vec3(0, 1.5, 0));
  run(world, 0.5);
  world.release(Vec3(3, 2, 0));
  EXPECT_FALSE(world.held().has_value());
  const Vec3 before = positionOf(world, 0);
  run(world, 0.25);
  const Vec3 flown = before + 0.25 * Vec3(3, 2, 0) + 0.5 * 0.25 * 0.25 * Vec3(0, -9.81, 0);
  EXPECT_LT((positionOf(world, 0) - flown).norm(), 0.03) << positionOf(world, 0).transpose();
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
  EXPECT_GT(positionOf(world, 0).y(), 1.0);
  ASSERT_TRUE(world.grab(1, Vec3(2, 0.6, 0)));
  world.moveGrab(Vec3(2, 1.5, 0));
  run(world, 3.0);
  EXPECT_LT(positionOf(world, 1).y(), 0.31);
}

TEST(WorldGrab, EachHandHoldsAPropOfItsOwn) {
  World world;
  for (int i = 0; i < World::kMaxHands; ++i) {
    world.addProp(ball(0.1, Vec3(i, 0.1, 0), 2.0));
    ASSERT_TRUE(world.grab(i, Vec3(i, 0.2, 0), i));
    world.moveGrab(Vec3(i, 0.8 + 0.05 * i, 0.5), i);
  }
  run(world, 2.0);
  for (int i = 0; i < World::kMaxHands; ++i) {
    ASSERT_TRUE(world.held(i).has_value());
    EXPECT_EQ(world.held(i)->prop, i);
    EXPECT_LT((world.held(i)->position - Vec3(i, 0.8 + 0.05 * i, 0.5)).norm(), 0.03) << i;
  }
  world.release(Vec3::Zero(), 1);
  ASSERT_TRUE(world.grab(4, positionOf(world, 4), 3)) << "another prop: the one before falls";
  run(world, 2.0);
  for (int i = 0; i < World::kMaxHands; ++i) {
    EXPECT_EQ(world.held(i).has_value(), i != 1) << i;
    EXPECT_EQ(positionOf(world, i).y() < 0.11, i == 1 || i == 3) << i;
  }
}

TEST(WorldGrab, BothHandsLiftWhatIsTooHeavyForOneAndTheLastLetsItFall) {
  World world;
  world.addProp(ball(0.3, Vec3(0, 0.3, 0), 80.0));
  ASSERT_TRUE(world.grab(0, Vec3(-0.2, 0.5, 0), 0));
  world.moveGrab(Vec3(-0.2, 1.5, 0), 0);
  run(world, 2.0);
  EXPECT_LT(positionOf(world, 0).y(), 0.31);
  ASSERT_TRUE(world.grab(0, Vec3(0.2, 0.5, 0), 5));
  world.moveGrab(Vec3(0.2, 1.5, 0), 5);
  run(world, 4.0);
  EXPECT_GT(positionOf(world, 0).y(), 1.0);
  world.release(Vec3(20, 0, 0), 0);
  EXPECT_LT(world.props()[0].velocity.norm(), 1.0) << "the other hand still holds it";
  world.step({}, kFrame);
  EXPECT_LT(world.props()[0].velocity.norm(), 1.0);
  EXPECT_TRUE(world.held(5).has_value());
  world.release(Vec3::Zero(), 5);
  run(world, 3.0);
  EXPECT_NEAR(positionOf(world, 0).y(), 0.3, 0.005);
}

TEST(WorldGrab, HandsThatPullApartHurlNothing) {
  World world;
  world.addProp(ball(0.1, Vec3(0, 1, 0), 0.5));
  for (int hand = 0; hand < 4; ++hand) ASSERT_TRUE(world.grab(0, Vec3(0, 1, 0), hand));
  std::mt19937_64 random(2);
  for (int i = 0; i < 200; ++i) {
    for (int hand = 0; i % 20 == 0 && hand < 4; ++hand) {
      world.moveGrab(Vec3(0, 1.5, 0) + test::uniformVec3(random, -3.0, 3.0), hand);
    }
    world.step({}, kFrame);
    ASSERT_LT(world.props()[0].velocity.norm(), 9.0) << i;
  }
}

TEST(WorldGrab, AHandThatIsNotThereHoldsNothing) {
  World world;
  world.addProp(ball(0.1, Vec3(0, 0.1, 0)));
  for (const int hand : {-1, World::kMaxHands}) {
    EXPECT_FALSE(world.grab(0, Vec3(0, 0.1, 0), hand));
    EXPECT_FALSE(world.held(hand).has_value());
    world.moveGrab(Vec3(0, 1, 0), hand);
    world.release(Vec3::Zero(), hand);
  }
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
    EXPECT_LT(positionOf(world, 0).x(), 0.87);
  }
}

/// A row of capsules from a position, each offset by `step`, fixed to the world at its start.
/// @return the last one
int addChain(World& world, const Vec3& begin, const Vec3& step, int links) {
  int before = kWorldItself;
  for (int i = 0; i < links; ++i) {
    Prop link;
    link.shape = PropShape::kCapsule;
    link.halfExtents = Vec3(0.018, 0.5 * step.norm(), 0.018);
    link.mass = 0.04;
    link.worldFromProp = Eigen::Translation3d(begin + (i + 0.5) * step);
    const int added = world.addProp(link);
    world.addLink(added, before, begin + i * step);
    before = added;
  }
  return before;
}

double fastestIn(const World& world) {
  double fastest = 0.0;
  for (const Prop& prop : world.props()) fastest = std::max(fastest, prop.velocity.norm());
  return fastest;
}

TEST(WorldLinks, AChainThatAnArmTearsDoesNotSnapBackFasterInShortSubsteps) {
  World::Settings weightless;
  weightless.gravity = Vec3::Zero();
  // Fixed at both ends. The arm is not held back: it pushes the middle aside by more than the length of the chain.
  const auto run = [&](double handSpeed) {
    World world(weightless);
    const int last = addChain(world, Vec3(0, 0.2, 0), Vec3(0, 0.2, 0), 8);
    world.addLink(last, kWorldItself, Vec3(0, 1.8, 0));
    // A hand next to it moves back and forth, so that substeps are short.
    std::array<LivePart, 2> avatar = {test::makeBoxPart(Vec3(0.2, 0.05, 0.05), at(0, 1, -0.08)),
                                      test::makeBoxPart(Vec3(0.05, 0.05, 0.05), at(0.3, 1.6, 0))};
    double fastest = 0.0;
    for (int frame = 0; frame < 60; ++frame) {
      test::moveTo(avatar[0], at(0, 1, -0.08 + 0.6 * std::min(1.0, frame / 30.0)));
      test::moveTo(avatar[1], at(0.3, 1.6, handSpeed * kFrame * (frame % 2 == 0 ? 0.5 : -0.5)));
      world.step(avatar, kFrame);
      fastest = std::max(fastest, fastestIn(world));
    }
    return fastest;
  };
  EXPECT_LT(run(0.0), 10.0);
  EXPECT_LT(run(24.0), 10.0);
}

TEST(WorldGrab, NothingIsHurledWhereALinkIsDraggedThroughChainsAndPastAnArm) {
  World world;
  constexpr int kLinks = 9;
  for (int chain = 0; chain < 6; ++chain) {
    addChain(world, Vec3(0.1 * chain, 1.9, 0.5), Vec3(0, -1.6 / kLinks, 0), kLinks);
  }
  std::array<LivePart, 2> avatar = {test::makeBoxPart(Vec3(0.2, 0.8, 0.12), at(0.25, 0.8, 0.3)),
                                    test::makeBoxPart(Vec3(0.05, 0.05, 0.3), at(0.25, 1.3, 0.45))};
  constexpr int kHeld = kLinks + kLinks / 2;
  Vec3 target = positionOf(world, kHeld), goal = target;
  ASSERT_TRUE(world.grab(kHeld, target));
  std::mt19937_64 random(1);
  for (int frame = 0; frame < 150; ++frame) {
    if ((goal - target).norm() < 0.01) goal = Vec3(0.25, 1.3, 0.5) + test::uniformVec3(random, -1.2, 1.2);
    target += (goal - target) * std::min(1.0, 3.0 * kFrame / std::max((goal - target).norm(), 1e-9));
    world.moveGrab(target);
    test::moveTo(avatar[0], avatar[0].worldFromPart);
    test::moveTo(avatar[1], at(0.25 + 0.3 * std::sin(0.13 * frame), 1.3, 0.45 + 0.3 * std::sin(0.2 * frame)));
    world.step(avatar, kFrame);
    ASSERT_LT(world.props()[kHeld].velocity.norm(), 9.0) << frame;
    ASSERT_LT(fastestIn(world), 20.0) << frame << ": ends of chains are faster than the part that strikes them";
  }
}

TEST(WorldThrow, TheOldestThrownComesBackAsTheNext) {
  World world;
  world.addProp(ball(0.2, Vec3(5, 0.2, 0)));
  for (int i = 0; i < World::kMaxThrown; ++i) {
    EXPECT_EQ(world.throwProp(ball(0.05, Vec3(-4.0 + 0.125 * i, 0.05, 0))), i + 1);
  }
  run(world, 0.5);
  Prop next = ball(0.1, Vec3(0, 3, 2));
  next.velocity = Vec3(0, 0, 4);
  EXPECT_EQ(world.throwProp(next), 1);
  EXPECT_EQ(std::ssize(world.props()), World::kMaxThrown + 1);
  EXPECT_EQ(world.props()[1].halfExtents.x(), 0.1);
  world.step({}, kFrame);
  EXPECT_NEAR(positionOf(world, 1).z(), 2 + 4 * kFrame, 1e-3);
  EXPECT_EQ(world.throwProp(next), 2);
  EXPECT_NEAR(positionOf(world, 0).x(), 5.0, 1e-3);
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
  EXPECT_NEAR(positionOf(world, carried).y(), 0.3, 0.005);
  for (int i = 0; i < World::kMaxThrown; ++i) world.throwProp(ball(0.05, Vec3(4, 1.0 + i, 4)));
  run(world, 1.0);
  EXPECT_NEAR(positionOf(world, carried).y(), 0.1, 0.005);
}

TEST(WorldThrow, AHeldPropThatIsThrownAgainIsLetGo) {
  World world;
  for (int i = 0; i < World::kMaxThrown; ++i) world.throwProp(ball(0.05, Vec3(0.2 * i, 0.05, 0)));
  for (const int hand : {0, 3}) ASSERT_TRUE(world.grab(0, Vec3(0, 0.1, 0), hand));
  EXPECT_EQ(world.throwProp(ball(0.05, Vec3(0, 1, 1))), 0);
  for (const int hand : {0, 3}) EXPECT_FALSE(world.held(hand).has_value());
  run(world, 0.1);
}

TEST(WorldHands, TheSameHandsDoTheSameTwice) {
  const auto last = [] {
    World world;
    for (int i = 0; i < 10; ++i) world.addProp(ball(0.1, Vec3(0.15 * i, 0.5 + 0.1 * i, 0)));
    std::vector<Isometry3> poses;
    for (int frame = 0; frame < 120; ++frame) {
      for (int hand = 0; hand < 3; ++hand) {  // two of them hold the same prop
        if (frame == 20) world.grab(3 + hand / 2, positionOf(world, 3 + hand / 2), hand);
        if (frame > 20 && frame < 60) world.moveGrab(Vec3(0.02 * frame, 1.0 + 0.2 * hand, 0.01 * frame), hand);
        if (frame == 60 + hand) world.release(Vec3::Zero(), hand);
      }
      if (frame % 3 == 0) {
        Prop thrown = ball(0.06, Vec3(0.5, 1, -3));
        thrown.velocity = Vec3(0, 2, 8);
        world.throwProp(thrown);
      }
      world.step({}, kFrame);
    }
    for (const Prop& prop : world.props()) poses.push_back(prop.worldFromProp);
    return poses;
  };
  const std::vector<Isometry3> first = last(), second = last();
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].matrix(), second[i].matrix()) << i;
}

}  // namespace
}  // namespace lorica
