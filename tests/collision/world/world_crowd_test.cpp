// Worlds with more parts than 128, whose islands step on their own.

#include "collision/world/world.h"
#include "tests/collision/parts.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;
using test::moveTo;

constexpr double kFrame = 1.0 / 30.0;

Prop boxOf(double half, const Isometry3& place) {
  Prop prop;
  prop.halfExtents = Vec3::Constant(half);
  prop.worldFromProp = place;
  return prop;
}

/// Parts that nothing can reach.
std::vector<LivePart> farAway(int count) {
  std::vector<LivePart> parts;
  for (int i = 0; i < count; ++i) parts.push_back(makeBoxPart(Vec3::Constant(0.1), at(0.5 * i, 50.0, 0.0)));
  return parts;
}

void stand(std::vector<LivePart>& parts) {
  for (LivePart& part : parts) moveTo(part, part.worldFromPart);
}

/// Parts that hurry about among props and links, then most of them leave. @return all numbers of all frames
std::vector<double> trace(int threads) {
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  std::mt19937_64 random(7);
  World world;
  for (int i = 0; i < 60; ++i) {
    Prop prop = boxOf(test::uniform(random, 0.05, 0.15), at(0.35 * (i % 8), 0.2 + 0.3 * (i % 3), 0.35 * (i / 8)));
    prop.shape = static_cast<PropShape>(i % kPropShapeCount);
    if (prop.shape == PropShape::kCapsule) prop.halfExtents.y() *= 2.0;
    world.addProp(prop);
  }
  world.addLink(3, 4, at(1.2, 0.4, 0.0).translation());
  std::vector<LivePart> parts;
  for (int i = 0; i < 160; ++i) {
    parts.push_back(makeBoxPart(Vec3::Constant(0.06), at(test::uniform(random, 0.0, 3.0), 0.3, 0.1 * (i % 30))));
  }
  std::vector<double> numbers;
  for (int frame = 0; frame < 60; ++frame) {
    if (frame == 40) parts.resize(20);
    for (LivePart& part : parts) {
      Isometry3 next = part.worldFromPart;
      next.translation() += test::uniformVec3(random, -0.08, 0.08);
      next.translation().y() = std::clamp(next.translation().y(), 0.0, 0.6);
      moveTo(part, next);
    }
    world.step(parts, kFrame);
    for (const Prop& prop : world.props()) {
      const Isometry3& pose = prop.worldFromProp;
      numbers.insert(numbers.end(), pose.matrix().data(), pose.matrix().data() + 16);
    }
    for (const Contact& contact : world.contacts()) numbers.push_back(contact.impulse);
  }
  return numbers;
}

TEST(WorldCrowd, AnyNumberOfThreadsMovesPropsTheSame) {
  const std::vector<double> one = trace(1);
  EXPECT_GT(one.size(), 60u * 60u * 16u) << "there are contacts";
  for (const int threads : {2, 3, 7}) EXPECT_EQ(trace(threads), one) << threads << " threads";
}

TEST(WorldCrowd, AStackOfBoxesStands) {
  World world;
  for (int i = 0; i < 6; ++i) world.addProp(boxOf(0.1, at(0.0, 0.1 + 0.2 * i, 0.0)));
  std::vector<LivePart> parts = farAway(150);
  for (int frame = 0; frame < 300; ++frame) {
    stand(parts);
    world.step(parts, kFrame);
  }
  for (int i = 0; i < 6; ++i) {
    const Vec3 moved = world.props()[i].worldFromProp.translation() - Vec3(0.0, 0.1 + 0.2 * i, 0.0);
    EXPECT_LT(moved.norm(), 0.01) << "box " << i;
    EXPECT_EQ(world.props()[i].velocity, Vec3::Zero()) << "it sleeps";
  }
}

TEST(WorldCrowd, APropThatLiesStillSleepsSoonAndASlowPendulumSwingsOn) {
  World world;
  world.addProp(boxOf(0.1, at(0.0, 0.12, 0.0)));
  Prop pendulum = boxOf(0.1, at(1.0, 0.5, 0.0));
  pendulum.velocity = Vec3(0.02, 0.0, 0.0);
  pendulum.angularVelocity = Vec3(0.0, 0.0, 0.02 / 0.3);
  world.addLink(world.addProp(pendulum), kWorldItself, Vec3(1.0, 0.8, 0.0));
  std::vector<LivePart> parts = farAway(150);
  double farthest = 0.0;
  for (int frame = 0; frame < 12; ++frame) {
    stand(parts);
    world.step(parts, kFrame);
    farthest = std::max(farthest, world.props()[1].worldFromProp.translation().x() - 1.0);
  }
  EXPECT_EQ(world.props()[0].velocity, Vec3::Zero()) << "it fell 2 cm and sleeps";
  EXPECT_GT(farthest, 0.002);
  EXPECT_GT(world.props()[1].velocity.norm(), 0.003) << "it was almost still for a moment only";
}

TEST(WorldCrowd, AFallingBoxGainsNoEnergyAndComesToRestOnTheFloor) {
  World world;
  std::mt19937_64 random(3);
  for (int i = 0; i < 40; ++i) world.addProp(boxOf(0.1, at(0.6 * (i % 7), 1.5 + 0.05 * i, 0.6 * (i / 7))));
  std::vector<LivePart> parts = farAway(150);
  std::vector<double> highest(40, 1e9);
  for (int frame = 0; frame < 150; ++frame) {
    stand(parts);
    world.step(parts, kFrame);
    for (std::size_t i = 0; i < world.props().size(); ++i) {
      const Prop& prop = world.props()[i];
      const double energy = 9.81 * prop.worldFromProp.translation().y() + 0.5 * prop.velocity.squaredNorm();
      EXPECT_LT(energy, highest[i] + 0.2) << "prop " << i << ", frame " << frame;
      highest[i] = std::min(highest[i], energy);
    }
  }
  for (const Prop& prop : world.props()) EXPECT_NEAR(prop.worldFromProp.translation().y(), 0.1, 0.005);
}

TEST(WorldCrowd, BallsRestOnPartsAndBoxesWhereTheyTouchThem) {
  World world;
  world.addProp(boxOf(0.2, at(0.0, 0.2, 0.0)));
  for (const double x : {0.0, 2.0}) {
    Prop ball = boxOf(0.1, at(x, 0.52, 0.0));
    ball.shape = PropShape::kSphere;
    world.addProp(ball);
  }
  std::vector<LivePart> parts = farAway(150);
  parts.push_back(makeBoxPart(Vec3::Constant(0.2), at(2.0, 0.2, 0.0)));
  for (int frame = 0; frame < 120; ++frame) {
    stand(parts);
    world.step(parts, kFrame);
    if (frame < 30) continue;
    for (const int ball : {1, 2}) {
      const Vec3 place = world.props()[ball].worldFromProp.translation();
      EXPECT_LT((place - Vec3(ball == 1 ? 0.0 : 2.0, 0.5, 0.0)).norm(), 0.003)
          << "ball " << ball << ", frame " << frame;
    }
  }
}

TEST(WorldCrowd, AFastPartNeverPassesThroughAThinBox) {
  for (double start = 0.5; start < 1.2; start += 0.037) {
    World::Settings settings;
    settings.gravity = Vec3::Zero();
    World world(settings);
    Prop prop = boxOf(0.2, at(0.0, 1.0, 0.0));
    prop.halfExtents.x() = 0.02;
    world.addProp(prop);
    std::vector<LivePart> parts = farAway(150);
    parts[70] = makeBoxPart(Vec3(0.01, 0.1, 0.1), at(-start, 1.0, 0.0));
    for (int frame = 0; frame < 4; ++frame) {
      stand(parts);
      moveTo(parts[70], at(-start + 20.0 * kFrame * (frame + 1), 1.0, 0.0));
      world.step(parts, kFrame);
    }
    EXPECT_GT(world.props()[0].velocity.x(), 19.0) << "from " << start;
  }
}

TEST(WorldCrowd, APropThatIsHitHitsOthersThatSleep) {
  World world;
  for (int i = 0; i < 3; ++i) world.addProp(boxOf(0.1, at(0.5 * i, 0.1, 0.0)));
  std::vector<LivePart> parts = farAway(150);
  parts[149] = makeBoxPart(Vec3::Constant(0.1), at(-1.0, 0.12, 0.0));
  for (int frame = 0; frame < 60; ++frame) {
    stand(parts);
    world.step(parts, kFrame);
  }
  ASSERT_EQ(world.props()[2].velocity, Vec3::Zero());
  for (int frame = 1; frame <= 30; ++frame) {
    stand(parts);
    moveTo(parts[149], at(std::min(-1.0 + 4.0 * kFrame * frame, 0.3), 0.12, 0.0));
    world.step(parts, kFrame);
  }
  EXPECT_GT(world.props()[2].worldFromProp.translation().x(), 1.05);
  for (int i = 1; i < 3; ++i) {
    const double gap =
        (world.props()[i].worldFromProp.translation() - world.props()[i - 1].worldFromProp.translation()).norm();
    EXPECT_GT(gap, 0.19) << "boxes " << i - 1 << " and " << i << " overlap";
  }
}

TEST(WorldCrowd, ASleepingPropFallsWhenItsSupportIsTakenAway) {
  World world;
  for (int i = 0; i < 2; ++i) world.addProp(boxOf(0.1, at(0.0, 0.1 + 0.2 * i, 0.0)));
  std::vector<LivePart> parts = farAway(150);
  parts[3] = makeBoxPart(Vec3(0.05, 0.05, 0.05), at(-1.0, 0.1, 0.0));
  for (int frame = 1; frame <= 90; ++frame) {
    stand(parts);
    if (frame > 60) moveTo(parts[3], at(-1.0 + 5.0 * kFrame * (frame - 60), 0.1, 0.0));
    world.step(parts, kFrame);
  }
  EXPECT_LT(world.props()[1].worldFromProp.translation().y(), 0.16);
}

TEST(WorldCrowd, AChainHangsFromItsLinks) {
  World world;
  for (int i = 0; i < 5; ++i) world.addProp(boxOf(0.05, at(0.0, 1.9 - 0.2 * i, 0.0)));
  world.addLink(0, kWorldItself, Vec3(0.0, 2.0, 0.0));
  for (int i = 1; i < 5; ++i) world.addLink(i - 1, i, Vec3(0.0, 2.0 - 0.2 * i, 0.0));
  std::vector<LivePart> parts = farAway(150);
  parts[0] = makeBoxPart(Vec3::Constant(0.05), at(-0.5, 1.1, 0.0));
  double farthest = 0.0;
  for (int frame = 0; frame < 90; ++frame) {
    stand(parts);
    if (frame > 40) moveTo(parts[0], at(std::min(0.3, -0.5 + 2.0 * kFrame * (frame - 40)), 1.1, 0.0));
    world.step(parts, kFrame);
    for (int i = 1; i < 5; ++i) {
      const Prop& above = world.props()[i - 1];
      const Prop& below = world.props()[i];
      const Vec3 gap = above.worldFromProp * Vec3(0, -0.1, 0) - below.worldFromProp * Vec3(0, 0.1, 0);
      EXPECT_LT(gap.norm(), 0.03) << "link " << i << ", frame " << frame;
    }
    farthest = std::max(farthest, world.props()[4].worldFromProp.translation().x());
  }
  EXPECT_GT(farthest, 0.2) << "the part pushes the chain";
}

TEST(WorldCrowd, APropHangsFromAStaticBodyAndFollowsAHand) {
  World world;
  Prop beam = boxOf(0.1, at(0.0, 2.0, 0.0));
  beam.mass = 0.0;
  world.addProp(beam);
  world.addProp(boxOf(0.1, at(0.0, 1.5, 0.0)));
  world.addLink(0, 1, Vec3(0.0, 1.9, 0.0));
  for (const double x : {3.0, 10.0}) world.addProp(boxOf(0.1, at(x, 0.1, 0.0)));
  std::vector<LivePart> parts = farAway(150);
  for (int frame = 0; frame < 90; ++frame) {
    stand(parts);
    for (const int hand : {0, 7}) {
      if (frame == 45) {
        ASSERT_TRUE(world.grab(2 + hand / 7, Vec3(3.0 + hand, 0.2, 0.0), hand));
      }
      world.moveGrab(Vec3(3.0 + hand, 1.2, 0.0), hand);
    }
    world.step(parts, kFrame);
    EXPECT_NEAR((world.props()[1].worldFromProp * Vec3(0.0, 0.4, 0.0) - Vec3(0.0, 1.9, 0.0)).norm(), 0.0, 0.01);
  }
  for (const int prop : {2, 3}) EXPECT_NEAR(world.props()[prop].worldFromProp.translation().y(), 1.1, 0.03) << prop;
}

}  // namespace
}  // namespace lorica
