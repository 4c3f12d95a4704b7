#include "collision/world/world.h"
#include "tests/collision/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;
using test::moveTo;

constexpr double kFrame = 1.0 / 30.0;

World weightless() {
  World::Settings settings;
  settings.gravity = Vec3::Zero();
  return World(settings);
}

Prop makeProp(PropShape shape, double halfSize, const Isometry3& pose) {
  Prop prop;
  prop.shape = shape;
  prop.halfExtents = Vec3::Constant(halfSize);
  prop.worldFromProp = pose;
  return prop;
}

Vec3 positionOf(const World& world, std::size_t prop = 0) {
  return world.props()[prop].worldFromProp.translation();
}

TEST(WorldParts, AHandAtTwoMetresASecondGivesABoxAtLeastThat) {
  for (double restitution : {0.0, 0.2, 1.0}) {
    World world = weightless();
    Prop prop = makeProp(PropShape::kBox, 0.1, at(0, 1.5, 0));
    prop.restitution = restitution;
    world.addProp(prop);
    LivePart hand = makeBoxPart(Vec3(0.04, 0.08, 0.08), at(-0.5, 1.5, 0));
    double deepest = 0.0;
    for (int i = 1; i <= 20; ++i) {
      moveTo(hand, at(-0.5 + 2.0 * kFrame * i, 1.5, 0));
      world.step({&hand, 1}, kFrame);
      for (const Contact& contact : world.contacts()) deepest = std::max(deepest, contact.depth);
    }
    const double speed = world.props()[0].velocity.x();
    EXPECT_GE(speed, 1.95) << "restitution " << restitution;
    EXPECT_LE(speed, 2.0 * (1.0 + restitution) + 0.05) << "restitution " << restitution;
    EXPECT_LT(deepest, 0.01) << "restitution " << restitution;
  }
}

TEST(WorldParts, APropThatAFootPressesIntoTheFloorDoesNotGoThroughIt) {
  for (const double x : {0.0, 0.05}) {
    World world;
    world.addProp(makeProp(PropShape::kBox, 0.1, at(0, 0.1, 0)));
    LivePart foot = makeBoxPart(Vec3(0.3, 0.05, 0.3), at(x, 0.5, 0));
    for (int i = 1; i <= 30; ++i) {
      moveTo(foot, at(x, std::max(0.05, 0.5 - 0.05 * i), 0));
      world.step({&foot, 1}, kFrame);
      EXPECT_GE(positionOf(world).y(), -1e-6) << "frame " << i;
    }
    moveTo(foot, at(5, 0.5, 0));
    for (int i = 0; i < 60; ++i) world.step({&foot, 1}, kFrame);
    EXPECT_NEAR(positionOf(world).y(), 0.1, 0.005) << "it rises again";
  }
}

TEST(WorldParts, ATurningArmGivesTheSpeedOfThePointItHitsWith) {
  World world = weightless();
  Prop prop = makeProp(PropShape::kSphere, 0.05, at(0.4, 1.5, 0.2));
  prop.restitution = 0.0;
  world.addProp(prop);
  LivePart arm = makeBoxPart(Vec3(0.5, 0.03, 0.03), at(0, 1.5, 0));
  for (int i = 1; i <= 4; ++i) {
    moveTo(arm, at(0, 1.5, 0) * Eigen::AngleAxisd(-3.0 * kFrame * i, Vec3::UnitY()));
    world.step({&arm, 1}, kFrame);
  }
  // They meet at sqrt(0.4^2 + 0.2^2 - 0.08^2) = 0.44 m from the axis: 3 rad/s * 0.44 m = 1.32 m/s. Then the ball slides
  // outwards along the arm for a tenth of a radian, which adds a little.
  EXPECT_GT(world.props()[0].velocity.norm(), 1.28);
  EXPECT_LT(world.props()[0].velocity.norm(), 1.45);
  EXPECT_GT(world.props()[0].velocity.z(), 1.0);
}

TEST(WorldParts, AFastHandDoesNotPassThroughABox) {
  for (double offset = 0.0; offset < 0.33; offset += 0.037) {
    World world = weightless();
    world.addProp(makeProp(PropShape::kBox, 0.1, at(0, 1.5, 0)));
    LivePart hand = makeBoxPart(Vec3(0.03, 0.08, 0.08), at(-1.0 - offset, 1.5, 0));
    bool touched = false;
    for (int i = 1; i <= 8; ++i) {
      moveTo(hand, at(-1.0 - offset + 10.0 * kFrame * i, 1.5, 0));
      world.step({&hand, 1}, kFrame);
      touched = touched || !world.contacts().empty();
    }
    EXPECT_TRUE(touched) << "a hit shorter than a frame is reported, offset " << offset;
    EXPECT_GT(world.props()[0].velocity.x(), 9.5) << "offset " << offset;
  }
}

TEST(WorldParts, ABallBouncesOnAPartAndComesToRestOnTop) {
  World world;
  Prop ball = makeProp(PropShape::kSphere, 0.1, at(0, 2.0, 0));
  ball.restitution = 0.6;
  world.addProp(ball);
  const LivePart table = makeBoxPart(Vec3(0.5, 0.1, 0.5), at(0, 0.9, 0));
  double fastestUp = 0.0;
  for (int i = 0; i < 240; ++i) {
    world.step({&table, 1}, kFrame);
    fastestUp = std::max(fastestUp, world.props()[0].velocity.y());
  }
  EXPECT_NEAR(fastestUp, 0.6 * std::sqrt(2.0 * 9.81 * 0.9), 0.1) << "read at the end of a frame";
  EXPECT_NEAR(positionOf(world).y(), 1.1, 0.003);
  ASSERT_FALSE(world.contacts().empty());
  EXPECT_GT(world.contacts()[0].normal.y(), 0.99) << "from the part to the prop";
  EXPECT_NEAR(world.contacts()[0].point.y(), 1.0, 0.004);
  double impulse = 0.0;
  for (const Contact& contact : world.contacts()) impulse += contact.impulse;
  EXPECT_NEAR(impulse, 1.0 * 9.81 * kFrame, 0.02 * 9.81 * kFrame) << "a resting prop is carried by m g t";
}

TEST(WorldParts, ABoxLiesStillOnAPartWhoseShapeChangesInEveryFrame) {
  World world;
  world.addProp(makeProp(PropShape::kBox, 0.1, at(0, 1.102, 0)));
  LivePart table = makeBoxPart(Vec3(0.5, 0.1, 0.5), at(0, 0.9, 0));
  for (int i = 0; i < 300; ++i) {
    test::reshapeToBox(table, Vec3(0.5 + (i % 2) * 0.01, 0.1, 0.5));
    world.step({&table, 1}, kFrame);
  }
  EXPECT_NEAR(positionOf(world).y(), 1.1, 0.003);
  // Friction loses its anchors with the contacts: it may creep by up to a millimetre per second.
  EXPECT_LT(positionOf(world).cwiseProduct(Vec3(1, 0, 1)).norm(), 0.01);
}

TEST(WorldParts, ACarriedBoxRidesAlong) {
  World world;
  world.addProp(makeProp(PropShape::kBox, 0.1, at(0, 1.101, 0)));
  LivePart tray = makeBoxPart(Vec3(0.3, 0.1, 0.3), at(0, 0.9, 0));
  for (int i = 0; i < 15; ++i) world.step({&tray, 1}, kFrame);
  for (int i = 1; i <= 60; ++i) {
    moveTo(tray, at(0.3 * kFrame * i, 0.9 + 0.2 * kFrame * i, 0));
    world.step({&tray, 1}, kFrame);
  }
  EXPECT_NEAR(positionOf(world).x(), 0.6, 0.06);
  EXPECT_NEAR(positionOf(world).y(), 1.5, 0.01);
}

/// A box rests on a part for a second, sleeping or not; then `change` is applied, and the box must fall freely.
void expectFallAfter(const std::function<std::vector<LivePart>(LivePart)>& change) {
  World world;
  world.addProp(makeProp(PropShape::kBox, 0.1, at(0, 1.602, 0)));
  LivePart table = makeBoxPart(Vec3(0.3, 0.3, 0.3), at(0, 1.2, 0));
  for (int i = 0; i < 150; ++i) world.step({&table, 1}, kFrame);
  const double y = positionOf(world).y();
  ASSERT_NEAR(y, 1.6, 0.004);

  std::vector<LivePart> changed = change(table);
  for (int i = 0; i < 6; ++i) {
    world.step(changed, kFrame);
    for (LivePart& part : changed) moveTo(part, part.worldFromPart);
    EXPECT_TRUE(world.contacts().empty());
  }
  EXPECT_NEAR(positionOf(world).y(), y - 0.5 * 9.81 * 0.2 * 0.2, 0.01);
}

TEST(WorldParts, ABoxFallsWhenWhatCarriedItShrinks) {
  expectFallAfter([](LivePart table) {
    test::reshapeToBox(table, Vec3(0.3, 0.02, 0.3));
    return std::vector<LivePart>{table};
  });
}

TEST(WorldParts, ABoxFallsWhenTheShapeSinksUnderItWithinItsBounds) {
  // The bounds still overlap, so Bullet keeps the pair, and with it the contacts that are no longer valid.
  expectFallAfter([](LivePart table) {
    test::reshape(table, std::vector<Vec3>{{-1.0, 0.35, -0.3},
                                           {-1.0, 0.35, 0.3},
                                           {-1.0, -0.5, -0.3},
                                           {-1.0, -0.5, 0.3},
                                           {0.3, -0.5, -0.3},
                                           {0.3, -0.5, 0.3}});
    return std::vector<LivePart>{table};
  });
}

TEST(WorldParts, ABoxFallsWhenWhatCarriedItJumpsAway) {
  expectFallAfter([](LivePart table) {
    moveTo(table, at(4.0, 1.2, 0));
    return std::vector<LivePart>{table};
  });
}

TEST(WorldParts, ABoxFallsWhenWhatCarriedItTurnsFlat) {
  expectFallAfter([](LivePart table) {
    test::reshape(table, std::vector<Vec3>{{-1, 0.3, -1}, {1, 0.3, -1}, {1, 0.3, 1}, {-1, 0.3, 1}});
    EXPECT_TRUE(table.shape.degenerate());
    return std::vector<LivePart>{table};
  });
}

TEST(WorldParts, ABoxFallsWhenTheAvatarIsGone) {
  expectFallAfter([](const LivePart&) { return std::vector<LivePart>{}; });
}

TEST(WorldParts, AJumpingPartThrowsNothing) {
  World world = weightless();
  world.addProp(makeProp(PropShape::kBox, 0.1, at(0, 1.5, 0)));
  LivePart hand = makeBoxPart(Vec3::Constant(0.05), at(-2.0, 1.5, 0));
  world.step({&hand, 1}, kFrame);
  moveTo(hand, at(2.0, 1.5, 0));
  world.step({&hand, 1}, kFrame);
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_LT(world.props()[0].velocity.norm(), 1e-6);
}

TEST(WorldParts, AHullThatGrowsLiftsWithoutKicking) {
  World world;
  world.addProp(makeProp(PropShape::kBox, 0.1, at(0, 1.101, 0)));
  LivePart table = makeBoxPart(Vec3(0.3, 0.1, 0.3), at(0, 0.9, 0));
  for (int i = 0; i < 30; ++i) world.step({&table, 1}, kFrame);
  test::reshapeToBox(table, Vec3(0.3, 0.15, 0.3));
  double fastest = 0.0;
  for (int i = 0; i < 30; ++i) {
    world.step({&table, 1}, kFrame);
    fastest = std::max(fastest, world.props()[0].velocity.norm());
  }
  EXPECT_LT(fastest, 0.2);
  EXPECT_NEAR(positionOf(world).y(), 1.15, 0.004);
}

TEST(WorldParts, PartsTouchNeitherTheFloorNorEachOther) {
  World world;
  world.addProp(makeProp(PropShape::kBox, 0.1, at(3, 0.1, 0)));
  std::vector<LivePart> parts = {makeBoxPart(Vec3::Constant(0.2), at(0, 0.0, 0)),
                                 makeBoxPart(Vec3::Constant(0.2), at(0.1, 0.1, 0))};
  for (int i = 0; i < 30; ++i) {
    moveTo(parts[0], at(0.01 * i, 0.0, 0));
    world.step(parts, kFrame);
    EXPECT_TRUE(world.contacts().empty());
  }
}

TEST(WorldParts, ContactsComeByPartThenProp) {
  World world;
  for (int i = 0; i < 4; ++i) world.addProp(makeProp(PropShape::kBox, 0.1, at(0.5 * i, 1.1, 0)));
  std::vector<LivePart> parts;
  for (int i = 3; i >= 0; --i) parts.push_back(makeBoxPart(Vec3(0.2, 0.1, 0.2), at(0.5 * i, 0.9, 0)));
  for (int i = 0; i < 10; ++i) world.step(parts, kFrame);
  ASSERT_GE(world.contacts().size(), 4u);
  for (std::size_t i = 1; i < world.contacts().size(); ++i) {
    const Contact& a = world.contacts()[i - 1];
    const Contact& b = world.contacts()[i];
    EXPECT_LE(std::make_pair(a.part, a.prop), std::make_pair(b.part, b.prop));
  }
  for (const Contact& contact : world.contacts()) {
    EXPECT_EQ(contact.part, 3 - contact.prop);
    EXPECT_NEAR(contact.normal.norm(), 1.0, 1e-5);
  }
}

TEST(WorldParts, AHullOfManyCornersCarriesAsItsShapeSays) {
  World world;
  world.addProp(makeProp(PropShape::kSphere, 0.05, at(0, 1.5, 0)));
  const TriMesh sphere = test::makeSphere(0.2, 20, 30);
  LivePart part = makeBoxPart(Vec3::Constant(0.1), at(0, 1.0, 0));
  test::reshape(part, sphere.vertices);
  ASSERT_GT(part.shape.vertices.size(), 500u);
  double lowest = 10.0;
  for (int i = 0; i < 30; ++i) {
    world.step({&part, 1}, kFrame);
    lowest = std::min(lowest, (positionOf(world) - Vec3(0, 1.0, 0)).norm());
  }
  EXPECT_NEAR(lowest, 0.25, 0.004);
}

TEST(WorldParts, AMinuteOfRandomMotionNeverGivesNonsense) {
  std::mt19937_64 random(31);
  World world;
  for (int i = 0; i < 25; ++i) {
    const PropShape shape = i % 2 == 0 ? PropShape::kBox : PropShape::kSphere;
    world.addProp(makeProp(shape, test::uniform(random, 0.04, 0.15), at(0.3 * (i % 5) - 0.6, 0.5 + 0.35 * i, 0)));
  }
  std::vector<LivePart> parts;
  for (int i = 0; i < 12; ++i) parts.push_back(makeBoxPart(Vec3::Constant(0.1), at(0, 1, 0)));
  for (int frame = 0; frame < 1800; ++frame) {
    for (LivePart& part : parts) {
      Isometry3 next = part.worldFromPart;
      next.translate(test::uniformVec3(random, -0.15, 0.15));
      next.rotate(Quat::Identity().slerp(test::uniform(random, 0.0, 0.3), test::uniformRotation(random)));
      next.translation() = next.translation().cwiseMax(Vec3(-0.8, 0.0, -0.8)).cwiseMin(Vec3(0.8, 1.8, 0.8));
      moveTo(part, next);
      if (random() % 4 == 0) test::reshapeToBox(part, test::uniformVec3(random, 0.02, 0.2));
      if (random() % 100 == 0) moveTo(part, at(0, test::uniform(random, 0.0, 5.0), 0));
    }
    world.step(parts, frame % 7 == 0 ? 0.1 : kFrame);
    for (const Prop& prop : world.props()) {
      ASSERT_TRUE(prop.worldFromProp.matrix().allFinite()) << "frame " << frame;
      ASSERT_TRUE(prop.velocity.allFinite()) << "frame " << frame;
      ASSERT_GT(prop.worldFromProp.translation().y(), -0.5) << "frame " << frame;
      ASSERT_LT(prop.velocity.norm(), 100.0) << "frame " << frame;
    }
    for (const Contact& contact : world.contacts()) {
      ASSERT_TRUE(contact.point.allFinite() && std::isfinite(contact.impulse) && contact.impulse >= 0.0);
    }
  }
}

/// A hand hits a ball; further parts are far from it. @return the ball's velocity after it
Vec3 velocityAmong(int others, double distance) {
  World world = weightless();
  world.addProp(makeProp(PropShape::kSphere, 0.1, at(0, 1.5, 0)));
  std::vector<LivePart> parts(1, makeBoxPart(Vec3(0.04, 0.08, 0.08), at(-0.5, 1.5, 0)));
  for (int i = 0; i < others; ++i) {
    parts.push_back(makeBoxPart(Vec3(0.04, 0.08, 0.08), at(distance + 0.5 * (i % 20), 1.5, 3.0 + 0.5 * (i / 20))));
  }
  for (int i = 1; i <= 20; ++i) {
    moveTo(parts[0], at(-0.5 + 3.0 * kFrame * i, 1.5, 0));
    for (std::size_t p = 1; p < parts.size(); ++p) moveTo(parts[p], parts[p].worldFromPart);
    world.step(parts, kFrame);
  }
  EXPECT_TRUE(world.contacts().empty());
  return world.props()[0].velocity;
}

TEST(WorldParts, InACrowdAHitIsTheSame) {
  const Vec3 bounced(3.6, 0.0, 0.0);  // the hand's 3 m/s and a restitution of 0.2
  const Vec3 alone = velocityAmong(0, 0.0);
  EXPECT_LT((alone - bounced).norm(), 0.15);
  EXPECT_EQ(velocityAmong(60, 2.0), alone);
  EXPECT_LT((velocityAmong(300, 2.0) - bounced).norm(), 0.05);
}

TEST(WorldParts, InACrowdAPartThatComesNearHitsToo) {
  for (const std::size_t first : {0u, 150u, 299u}) {
    World world = weightless();
    world.addProp(makeProp(PropShape::kSphere, 0.1, at(0, 1.5, 0)));
    std::vector<LivePart> parts;
    for (int i = 0; i < 300; ++i)
      parts.push_back(makeBoxPart(Vec3(0.04, 0.08, 0.08), at(0.5 * (i % 20), 9.0, 0.5 * i)));
    bool hit = false;
    for (int i = 0; i <= 40; ++i) {
      for (std::size_t p = 0; p < parts.size(); ++p) moveTo(parts[p], parts[p].worldFromPart);
      moveTo(parts[first], at(-5.0 + 4.0 * kFrame * i, 1.5, 0));
      world.step(parts, kFrame);
      for (const Contact& contact : world.contacts()) {
        EXPECT_EQ(contact.part, static_cast<PartIndex>(first));
        hit = true;
      }
    }
    EXPECT_TRUE(hit) << first;
    EXPECT_GT(world.props()[0].velocity.x(), 3.9);
  }
}

}  // namespace
}  // namespace lorica
