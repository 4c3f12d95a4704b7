#include "collision/world/world.h"
#include "tests/collision/parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;
using test::moveTo;
using test::uniform;
using test::uniformRotation;
using test::uniformVec3;

World weightless() {
  World::Settings settings;
  settings.gravity = Vec3::Zero();
  return World(settings);
}

Prop makeProp(PropShape shape, const Vec3& halfExtents, const Isometry3& pose) {
  Prop prop;
  prop.shape = shape;
  prop.halfExtents = halfExtents;
  prop.mass = 0.6;
  prop.worldFromProp = pose;
  return prop;
}

/// A hand that moves on a straight line at constant speed to a target and through it.
class Hand {
 public:
  Hand(const Vec3& halfExtents, const Quat& rotation, const Vec3& target, const Vec3& velocity, double lead)
      : rotation_(rotation),
        position_(target - lead * velocity),
        velocity_(velocity),
        part_(makeBoxPart(halfExtents, Eigen::Translation3d(position_) * rotation)) {}

  void step(World& world, double seconds) {
    position_ += seconds * velocity_;
    moveTo(part_, Eigen::Translation3d(position_) * rotation_);
    world.step({&part_, 1}, seconds);
    for (const Contact& contact : world.contacts()) {
      touched_ = true;
      deepest_ = std::max(deepest_, contact.depth);
    }
  }
  [[nodiscard]] const Vec3& position() const { return position_; }
  [[nodiscard]] bool touched() const { return touched_; }
  [[nodiscard]] double deepest() const { return deepest_; }

 private:
  Quat rotation_;
  Vec3 position_, velocity_;
  LivePart part_;
  bool touched_ = false;
  double deepest_ = 0.0;
};

TEST(WorldHits, ABallAtRestLeavesAtOnePlusRestitutionTimesTheHand) {
  std::mt19937_64 random(51);
  const double rates[] = {24.0, 30.0, 60.0, 120.0};
  for (int i = 0; i < 400; ++i) {
    const double restitution = 0.25 * (i % 5);
    const double speed = uniform(random, 1.0, 24.9);
    const double seconds = 1.0 / rates[i % 4];
    const Vec3 direction = uniformRotation(random) * Vec3::UnitX();
    // The hitting face is tilted by up to 30 degrees and hits slightly off its centre.
    // One statement per random number: the evaluation order of arguments differs between compilers.
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    const double angle = uniform(random, 0.0, 0.5);
    const Quat rotation = Eigen::AngleAxisd(angle, axis) * Quat::FromTwoVectors(Vec3::UnitX(), direction);
    const Vec3 normal = rotation * Vec3::UnitX();

    World world = weightless();
    const Vec3 middle(0.3, 20.0, 0.2);  // high enough not to reach the floor in a frame or two
    Prop ball = makeProp(PropShape::kSphere, Vec3::Constant(0.1), at(middle.x(), middle.y(), middle.z()));
    ball.restitution = restitution;
    ball.friction = 0.0;
    world.addProp(ball);
    const Vec3 target = middle + uniformVec3(random, -0.02, 0.02);
    const double lead = (2.0 + uniform(random, 0.0, 1.0)) * seconds + 0.3 / speed;
    const double thickness = uniform(random, 0.01, 0.05);
    Hand hand(Vec3(thickness, 0.15, 0.2), rotation, target, speed * direction, lead);
    for (int frame = 0; frame < 1000 && !hand.touched(); ++frame) hand.step(world, seconds);
    hand.step(world, seconds);
    // In the hand's frame, the ball hits an infinitely heavy wall: its normal velocity is reversed. Overlaps of less
    // than 2 mm are resolved with up to 0.12 m/s.
    const Vec3 expected = (1.0 + restitution) * speed * direction.dot(normal) * normal;
    EXPECT_LT((world.props()[0].velocity - expected).norm(), 0.001 * speed + 0.12)
        << "case " << i << ", " << speed << " m/s, restitution " << restitution;
  }
}

TEST(WorldHits, ABallThatComesTowardsTheHandBouncesOffIt) {
  std::mt19937_64 random(52);
  for (int i = 0; i < 100; ++i) {
    const double restitution = 0.25 * (i % 5);
    const double speed = uniform(random, 0.0, 15.0);
    const double thrown = uniform(random, 1.0, 15.0);
    World world = weightless();
    const double away = uniform(random, 1.0, 2.0);
    Prop ball = makeProp(PropShape::kSphere, Vec3::Constant(0.1), at(0.1 + away * thrown / (speed + thrown), 1.5, 0));
    ball.velocity = Vec3(-thrown, 0, 0);
    ball.restitution = restitution;
    world.addProp(ball);
    Hand hand(Vec3(0.01, 0.1, 0.1), Quat::Identity(), Vec3(0, 1.5, 0), Vec3(speed, 0, 0), away / (speed + thrown));
    for (int frame = 0; frame < 100 && !hand.touched(); ++frame) hand.step(world, 1.0 / 30.0);
    ASSERT_TRUE(hand.touched());
    hand.step(world, 1.0 / 30.0);
    EXPECT_NEAR(world.props()[0].velocity.x(), speed + restitution * (speed + thrown), 0.005 * (speed + thrown) + 0.12)
        << "case " << i << ", " << speed << " and " << thrown << " m/s, restitution " << restitution;
  }
}

TEST(WorldHits, ABoxHitFlatTakesTheHandsVelocity) {
  std::mt19937_64 random(53);
  for (int i = 0; i < 100; ++i) {
    const double restitution = 0.25 * (i % 5);
    const double speed = uniform(random, 2.0, 20.0);
    World world = weightless();
    Prop box = makeProp(PropShape::kBox, Vec3::Constant(0.1), at(0, 1.5, 0));
    box.restitution = restitution;
    world.addProp(box);
    Hand hand(Vec3(0.03, 0.15, 0.15), Quat::Identity(), Vec3(0, 1.5, 0), Vec3(speed, 0, 0),
              uniform(random, 0.067, 0.1) + 0.2 / speed);
    for (int frame = 0; frame < 100 && !hand.touched(); ++frame) hand.step(world, 1.0 / 30.0);
    hand.step(world, 1.0 / 30.0);
    // A corner may touch before the others and tilt the box slightly.
    EXPECT_NEAR(world.props()[0].velocity.x(), (1.0 + restitution) * speed, 0.05 * speed) << "case " << i;
  }
}

/// One kind of hit.
struct Hit {
  PropShape shape = PropShape::kBox;
  Vec3 prop = Vec3::Constant(0.1);
  Vec3 hand = Vec3(0.01, 0.05, 0.09);  ///< half its thickness, width, length [m]
  double speed = 15.0;
  double framesPerSecond = 30.0;
  bool onFloor = false;
};

/// A hundred hits near the centre, flat and with the hand in any orientation, from all directions, at all phases of a
/// frame. None may pass through: the prop is touched, leaves as fast as the hand, and the two never overlap deeply.
void expectNoneThrough(const Hit& hit, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (int i = 0; i < 100; ++i) {
    const bool flat = i % 2 == 0;
    World::Settings settings;
    if (!hit.onFloor) settings.gravity = Vec3::Zero();
    World world(settings);
    Quat attitude = uniformRotation(random);
    Vec3 direction = uniformRotation(random) * Vec3::UnitX();
    Vec3 offset = 0.3 * hit.prop.minCoeff() * uniformVec3(random, -1.0, 1.0);
    if (hit.onFloor) {
      attitude = Quat(Eigen::AngleAxisd(uniform(random, 0.0, std::numbers::pi), Vec3::UnitY()));
      const double heading = uniform(random, 0.0, 2.0 * std::numbers::pi);
      direction = Vec3(std::cos(heading), 0.0, std::sin(heading));
      offset.y() = 0.0;
    }
    const Vec3 middle(0.3, hit.onFloor ? hit.prop.y() : 20.0, 0.2);
    world.addProp(makeProp(hit.shape, hit.prop, Eigen::Translation3d(middle) * attitude));
    const Quat rotation = flat ? Quat::FromTwoVectors(Vec3::UnitX(), direction) : uniformRotation(random);
    const double seconds = 1.0 / hit.framesPerSecond;
    const double lead = (2.0 + uniform(random, 0.0, 1.0)) * seconds + 0.2 / hit.speed;
    Hand hand(hit.hand, rotation, middle + offset, hit.speed * direction, lead);
    for (double time = 0.0; time < lead + 0.2 / hit.speed; time += seconds) hand.step(world, seconds);

    const Vec3 velocity = world.props()[0].velocity;
    const Vec3 ahead = world.props()[0].worldFromProp.translation() - hand.position();
    EXPECT_TRUE(hand.touched()) << "case " << i;
    EXPECT_LT(hand.deepest(), 0.035) << "case " << i;
    EXPECT_GT(velocity.norm(), 0.5 * hit.speed) << "case " << i;
    if (!flat) continue;  // an edge may deflect it sideways
    EXPECT_GT(velocity.dot(direction), 0.7 * hit.speed) << "case " << i;
    EXPECT_GT(ahead.dot(direction), 0.0) << "case " << i;
  }
}

TEST(WorldHits, ABoxIsNotTunnelledByAFlatHand) {
  expectNoneThrough({}, 61);
}

TEST(WorldHits, ABoxIsNotTunnelledByAHandJustBelowAJump) {
  expectNoneThrough({.speed = 24.5}, 62);
}

TEST(WorldHits, ABoxIsNotTunnelledAtOtherFrameRates) {
  expectNoneThrough({.framesPerSecond = 15.0}, 63);
  expectNoneThrough({.framesPerSecond = 60.0}, 64);
}

TEST(WorldHits, ABoxIsNotTunnelledByAKick) {
  expectNoneThrough({.hand = Vec3(0.05, 0.05, 0.12), .speed = 20.0}, 65);
}

TEST(WorldHits, ABallIsNotTunnelled) {
  expectNoneThrough({.shape = PropShape::kSphere}, 66);
  expectNoneThrough({.shape = PropShape::kSphere, .hand = Vec3(0.05, 0.05, 0.12), .speed = 20.0}, 67);
}

TEST(WorldHits, WhatLiesOnTheFloorIsNotTunnelled) {
  expectNoneThrough({.onFloor = true}, 68);
  expectNoneThrough({.hand = Vec3(0.05, 0.05, 0.12), .speed = 20.0, .onFloor = true}, 69);
  expectNoneThrough({.shape = PropShape::kSphere, .hand = Vec3(0.05, 0.05, 0.12), .speed = 20.0, .onFloor = true}, 70);
}

TEST(WorldHits, AThinBoxIsNotTunnelled) {
  expectNoneThrough({.prop = Vec3(0.02, 0.1, 0.15)}, 71);
  expectNoneThrough({.prop = Vec3(0.02, 0.1, 0.15), .hand = Vec3(0.05, 0.05, 0.12), .speed = 20.0}, 72);
}

TEST(WorldHits, AFastHandFarFromPropsChangesNothing) {
  const auto fall = [](bool withHand) {
    World world;
    world.addProp(makeProp(PropShape::kBox, Vec3::Constant(0.1), at(0, 1.5, 0)));
    world.addProp(makeProp(PropShape::kSphere, Vec3::Constant(0.1), at(0, 2.5, 0)));
    LivePart hand = makeBoxPart(Vec3(0.01, 0.05, 0.09), at(3, 1, -10));
    for (int frame = 0; frame < 30; ++frame) {
      moveTo(hand, at(3, 1, -10 + 0.7 * frame));
      world.step({&hand, withHand ? 1u : 0u}, 1.0 / 30.0);
    }
    return std::vector<Prop>(world.props().begin(), world.props().end());
  };
  const std::vector<Prop> alone = fall(false);
  const std::vector<Prop> passed = fall(true);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(alone[i].worldFromProp.matrix(), passed[i].worldFromProp.matrix());
    EXPECT_EQ(alone[i].velocity, passed[i].velocity);
  }
}

}  // namespace
}  // namespace lorica
