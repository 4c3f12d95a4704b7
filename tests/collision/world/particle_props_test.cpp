#include "collision/particles/fluid.h"
#include "collision/particles/granular.h"
#include "collision/particles/particle_push.h"
#include "collision/particles/particles.h"
#include "collision/world/world.h"

#include "tests/collision/parts.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <vector>

namespace lorica::test {
namespace {

constexpr double kFrame = 1.0 / 30.0, kWater = 1000.0, kSpacing = 0.025;

/// A basin of water around the origin.
ParticleSettings pool(double width, double depth, double spacing = kSpacing) {
  ParticleSettings settings;
  settings.kind = ParticleSettings::Kind::kWater;
  settings.radius = 0.5 * spacing;
  settings.walls = Aabb{Vec3(-0.5 * width, 0, -0.5 * width), Vec3(0.5 * width, 9, 0.5 * width)};
  settings.fills.push_back({Vec3(0.0, 0.5 * depth, 0.0), Vec3(width, depth, width)});
  settings.settleSeconds = 1.0;
  return settings;
}

/// A heap of sand around the origin, as wide as its walls.
ParticleSettings bed(double width, double depth) {
  ParticleSettings settings = pool(width, depth, 0.02);
  settings.kind = ParticleSettings::Kind::kSand;
  return settings;
}

Prop box(const Vec3& half, double density, const Vec3& at) {
  Prop prop;
  prop.halfExtents = half;
  prop.mass = density * 8.0 * half.prod();
  prop.worldFromProp.translation() = at;
  return prop;
}

Prop ball(double radius, double density, const Vec3& at) {
  Prop prop = box(Vec3::Constant(radius), density, at);
  prop.shape = PropShape::kSphere;
  prop.mass *= std::numbers::pi / 6.0;
  return prop;
}

void run(World& world, int frames) {
  for (int f = 0; f < frames; ++f) world.step({}, kFrame);
}

/// The level of water away from the middle: twice the mean height.
double levelAround(const World& world, double away) {
  double sum = 0.0, count = 0.0;
  for (const Vec3f& p : world.particles()->positions()) {
    if (std::max(std::abs(p.x()), std::abs(p.z())) < away) continue;
    sum += p.y();
    count += 1.0;
  }
  return 2.0 * sum / count;
}

double uprightness(const Prop& prop) {
  return prop.worldFromProp.linear()(1, 1);
}

TEST(ParticleProps, ABoxFloatsAsDeepAsItsDensitySays) {
  for (const double density : {300.0, 700.0}) {
    World world;
    const Vec3 half(0.15, 0.06, 0.15);
    world.addProp(box(half, density, {0.0, 0.26, 0.0}));
    EXPECT_TRUE(world.setParticles(pool(0.6, 0.25)));
    run(world, 75);
    double in = 0.0;
    for (int f = 0; f < 30; ++f) {
      world.step({}, kFrame);
      in += (levelAround(world, 0.22) - world.props()[0].worldFromProp.translation().y() + half.y()) / 30.0;
    }
    EXPECT_NEAR(in, 2.0 * half.y() * density / 1000.0, (density < 500.0 ? 0.05 : 0.08) * 2.0 * half.y()) << density;
    EXPECT_GT(uprightness(world.props()[0]), 0.98) << density;
  }
}

TEST(ParticleProps, AHeavyBallSinksAndALightOneRises) {
  World world;
  world.addProp(ball(0.06, 2000.0, {0.12, 0.35, 0.0}));
  world.addProp(ball(0.06, 300.0, {-0.12, 0.12, 0.0}));
  EXPECT_TRUE(world.setParticles(pool(0.5, 0.25)));
  run(world, 90);
  EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), 0.06, 0.005);
  EXPECT_GT(world.props()[1].worldFromProp.translation().y(), 0.2);
}

TEST(ParticleProps, WallsOfWaterHoldASunkBox) {
  World world;
  world.addProp(box({0.06, 0.06, 0.06}, 2000.0, {0.23, 0.07, 0.0}));
  EXPECT_TRUE(world.setParticles(pool(0.6, 0.4)));
  run(world, 150);
  const Vec3 at = world.props()[0].worldFromProp.translation();
  EXPECT_LT(at.x() + 0.06, 0.3 + 1e-3);
  EXPECT_NEAR(at.y(), 0.06, 0.01);
}

TEST(ParticleProps, ATiltedRaftRightsItself) {
  World world;
  Prop raft = box({0.12, 0.03, 0.12}, 400.0, {0.0, 0.3, 0.0});
  raft.worldFromProp.rotate(Eigen::AngleAxisd(1.0, Vec3::UnitZ()));
  world.addProp(raft);
  EXPECT_TRUE(world.setParticles(pool(0.6, 0.25)));
  run(world, 90);
  EXPECT_GT(uprightness(world.props()[0]), 0.98);
}

TEST(ParticleProps, ABoxAndALumpOfWaterKeepTheirMomentum) {
  World::Settings space;
  space.gravity = Vec3::Zero();
  space.floor = false;
  World world(space);
  Prop prop = box({0.1, 0.08, 0.12}, 400.0, {-0.35, 1.03, 0.04});
  prop.velocity = Vec3(1.0, 0.0, 0.0);
  world.addProp(prop);
  ParticleSettings water = pool(0.3, 0.3);
  water.walls.reset();
  water.floor = false;
  water.gravity = Vec3::Zero();
  water.settleSeconds = 0.0;
  water.fills[0].middle.y() = 1.0;
  EXPECT_TRUE(world.setParticles(water));
  const double mass = kWater * std::pow(kSpacing, 3.0);
  const auto momentum = [&] {
    Vec3 sum = prop.mass * world.props()[0].velocity;
    for (const Vec3f& v : world.particles()->velocities()) sum += mass * v.cast<double>();
    return sum;
  };
  world.step({}, kFrame);
  const Vec3 before = momentum();
  const Vec3 own = prop.mass * world.props()[0].velocity;
  run(world, 15);
  const double impulse = (prop.mass * world.props()[0].velocity - own).norm();
  EXPECT_LT((momentum() - before).norm(), 1e-3 * impulse);
}

TEST(ParticleProps, SandCarriesABallThatStoppedInACrater) {
  World world;
  const double radius = 0.08, width = 0.6, depth = 0.25;
  world.addProp(ball(radius, 1500.0, {0.0, 0.9, 0.0}));
  EXPECT_TRUE(world.setParticles(bed(width, depth)));
  run(world, 90);
  const Vec3 rests = world.props()[0].worldFromProp.translation();
  EXPECT_LT(rests.y(), depth + radius) << "dented";
  EXPECT_GT(rests.y(), radius + 0.02) << "carried";
  run(world, 60);
  EXPECT_LT((world.props()[0].worldFromProp.translation() - rests).norm(), 0.01) << "at rest";
  for (const Vec3f& p : world.particles()->positions()) {
    EXPECT_GT((p.cast<double>() - world.props()[0].worldFromProp.translation()).norm(), radius);
  }
}

/// Boxes, balls and a chain that fall into water.
World wetWorld(ParticleSettings settings) {
  World world;
  for (int i = 0; i < 4; ++i) {
    world.addProp(box({0.04, 0.05, 0.06}, 300.0 + 300.0 * i, {-0.15 + 0.1 * i, 0.3 + 0.1 * i, 0.05}));
  }
  world.addProp(ball(0.05, 100.0, {0.0, 0.1, -0.1}));
  world.addLink(0, 1, {-0.1, 0.35, 0.05});
  EXPECT_TRUE(world.setParticles(settings));
  return world;
}

TEST(ParticleProps, ThreadsChangeNoBit) {
  const auto result = [](const ParticleSettings& settings, std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    World world = wetWorld(settings);
    run(world, 15);
    std::vector<double> numbers;
    for (const Prop& prop : world.props()) {
      const Vec3 at = prop.worldFromProp.translation();
      numbers.insert(numbers.end(), {at.x(), at.y(), at.z(), prop.angularVelocity.x()});
    }
    for (const Vec3f& p : world.particles()->positions()) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
    return numbers;
  };
  ParticleSettings water = pool(0.5, 0.2), sand = bed(0.4, 0.1);
  water.settleSeconds = sand.settleSeconds = 0.1;
  EXPECT_EQ(result(water, 1), result(water, 4));
  EXPECT_EQ(result(sand, 1), result(sand, 4));
}

TEST(ParticleProps, ManyFramesStayBoundedAndAllocateNothing) {
  const int frames = std::getenv("LORICA_LONG_TESTS") != nullptr ? 10'000 : 150;
  World world = wetWorld(pool(0.5, 0.2, 0.04));
  world.addProp(ball(0.03, 1e6, {0.1, 0.5, -0.1}));
  world.addProp(ball(0.06, 0.01, {0.1, 0.1, 0.15}));  // a bubble under water
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  run(world, 60);
  const long before = allocationCount();
  for (int f = 0; f < frames; ++f) {
    world.step({}, kFrame);
    for (const Prop& prop : world.props()) {
      ASSERT_LT(prop.worldFromProp.translation().norm(), 20.0) << f;
      ASSERT_LT(prop.velocity.norm(), 31.0) << f;
    }
  }
  EXPECT_LT(allocationCount() - before, 4) << "contacts of more particles than ever before";
  for (const Vec3f& p : world.particles()->positions()) ASSERT_TRUE(p.allFinite());
}

TEST(ParticleProps, WaterWithoutAFloorFallsAndWhoStartsInThePoolIsLeft) {
  World::Settings open;
  open.floor = false;
  World world(open);
  world.addProp(box({0.1, 0.1, 0.1}, 500.0, {0.1, 0.1, 0.0}));
  world.addProp(box({0.1, 0.1, 0.1}, 500.0, {0.14, 0.12, 0.03}));  // in the other, and both under water
  ParticleSettings water = pool(0.5, 0.3, 0.04);
  water.floor = false;
  EXPECT_TRUE(world.setParticles(water));
  const LivePart leg = makeBoxPart(Vec3(0.06, 0.3, 0.06), at(-0.1, 0.2, 0.0));
  for (int f = 0; f < 30; ++f) {
    world.step({&leg, 1}, kFrame);
    for (const Vec3f& p : world.particles()->positions()) {
      ASSERT_TRUE(p.allFinite());
      const Vec3 own = (leg.worldFromPart.inverse() * p.cast<double>()).cwiseAbs();
      ASSERT_FALSE(own.x() < 0.06 && own.y() < 0.3 && own.z() < 0.06);
    }
  }
  for (const Vec3f& p : world.particles()->positions()) EXPECT_LT(p.y(), -2.0f);
  for (const Prop& prop : world.props()) EXPECT_LT(prop.velocity.norm(), 20.0);
}

TEST(ParticleSettings, OutOfRangeAreRefusedWithASentence) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto expectRefused = [](const auto& made, double value) {
    ASSERT_FALSE(made.ok()) << value;
    EXPECT_EQ(made.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(made.error().message.find("found"), std::string::npos) << made.error().message;
  };
  World world;
  ASSERT_TRUE(world.setParticles(ParticleSettings()));
  const Particles* before = world.particles();
  for (const double wrong : {0.0, -0.01, nan, inf}) {
    for (const auto kind : {ParticleSettings::Kind::kSand, ParticleSettings::Kind::kWater}) {
      ParticleSettings settings;
      settings.kind = kind;
      settings.radius = wrong;
      expectRefused(Particles::create(settings), wrong);
      expectRefused(world.setParticles(settings), wrong);
      settings.radius = 0.02;
      settings.pours.resize(1);
      settings.pours[0].radius = wrong;
      expectRefused(Particles::create(settings), wrong);
    }
    for (double GranularSettings::*number : {&GranularSettings::radius, &GranularSettings::substepSeconds}) {
      GranularSettings settings;
      settings.*number = wrong;
      expectRefused(Granular::create(settings), wrong);
    }
    for (double FluidSettings::*number : {&FluidSettings::spacing, &FluidSettings::substepSeconds}) {
      FluidSettings settings;
      settings.*number = wrong;
      expectRefused(Fluid::create(settings), wrong);
    }
    if (wrong != 0.0) expectRefused(ParticlePush::create({.radius = wrong}), wrong);
  }
  FluidSettings still;
  still.iterations = 0;
  expectRefused(Fluid::create(still), 0);
  EXPECT_TRUE(ParticlePush::create({.radius = 0.0}).ok());
  EXPECT_EQ(world.particles(), before) << "what is refused replaces nothing";
}

}  // namespace
}  // namespace lorica::test
