#include "collision/particles/fluid.h"

#include "collision/particles/standing_water.h"
#include "tests/collision/parts.h"
#include "tests/support/allocations.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica::test {
namespace {

constexpr double kFrame = 1.0 / 30.0;
constexpr float kSpacing = 0.04f;

/// A dam in one half of a trough that is `wide` * 2 particles long.
Fluid dam(int wide, int high) {
  FluidSettings settings;
  settings.capacity = static_cast<std::size_t>(wide) * static_cast<std::size_t>(wide * high);
  settings.spacing = kSpacing;
  const double half = 0.5 * wide * kSpacing;
  settings.walls = Aabb{Vec3(-half, 0, -2.0 * half), Vec3(half, 9, 2.0 * half)};
  Fluid fluid = Fluid::create(settings).value();
  std::vector<Vec3f> positions;
  positions.reserve(settings.capacity);
  const auto left = static_cast<float>(-half);
  for (int y = 0; y < high; ++y) {
    for (int z = 0; z < wide; ++z) {
      for (int x = 0; x < wide; ++x) {
        positions.emplace_back(left + (static_cast<float>(x) + 0.5f) * kSpacing,
                               (static_cast<float>(y) + 0.5f) * kSpacing,
                               2.0f * left + (static_cast<float>(z) + 0.5f) * kSpacing);
      }
    }
  }
  EXPECT_EQ(fluid.add(positions), positions.size());
  return fluid;
}

double meanHeight(const Fluid& fluid) {
  double sum = 0.0;
  for (const Vec3f& p : fluid.positions()) sum += p.y();
  return sum / static_cast<double>(fluid.size());
}

TEST(Fluid, FallsFreelyAsTheClosedFormSays) {
  FluidSettings settings;
  settings.capacity = 1;
  Fluid fluid = Fluid::create(settings).value();
  fluid.add(std::vector<Vec3f>{Vec3f(0.1f, 3.0f, 0.0f)}, Vec3(-0.5, 1.0, 0.0));
  const int frames = 12;
  for (int i = 0; i < frames; ++i) fluid.step({}, kFrame);
  const double t = frames * kFrame, h = 1.0 / 120.0;
  EXPECT_NEAR(fluid.positions()[0].x(), 0.1 - 0.5 * t, 1e-4);
  EXPECT_NEAR(fluid.positions()[0].y(), 3.0 + t - 0.5 * 9.81 * t * (t + h), 1e-3);
}

TEST(Fluid, ADamBreaksSpreadsAndKeepsItsVolume) {
  Fluid fluid = dam(10, 16);
  for (int i = 0; i < 150; ++i) {
    fluid.step({}, kFrame);
    for (const Vec3f& p : fluid.positions()) {
      ASSERT_TRUE(p.allFinite());
      ASSERT_GE(p.y(), 0.5f * kSpacing - 1e-6f);
    }
  }
  // At rest it stands half as high in twice the space.
  EXPECT_NEAR(meanHeight(fluid), 0.25 * 16 * kSpacing, 0.08 * 0.25 * 16 * kSpacing);
  std::vector<float> along;
  for (const Vec3f& p : fluid.positions()) along.push_back(p.z());
  std::sort(along.begin(), along.end());
  EXPECT_NEAR(along[along.size() / 2], 0.0f, 0.06f) << "half of the fluid on either side";
  double speed = 0.0;
  for (const Vec3f& v : fluid.velocities()) speed += v.norm() / static_cast<double>(fluid.size());
  EXPECT_LT(speed, 0.3);
}

TEST(Fluid, DeepWaterStaysWhereItIs) {
  for (const int layers : {15, 30, 50}) {
    FluidSettings settings;
    settings.capacity = static_cast<std::size_t>(10 * 10 * layers);
    const double half = 5.0 * settings.spacing;
    settings.walls = Aabb{Vec3(-half, 0, -half), Vec3(half, 9, half)};
    Fluid fluid = Fluid::create(settings).value();
    std::vector<Vec3f> positions;
    positions.reserve(settings.capacity);
    for (int i = 0; i < 100 * layers; ++i) {
      positions.emplace_back(static_cast<float>(settings.spacing) * Vec3f(static_cast<float>(i % 10) - 4.5f,
                                                                          static_cast<float>(i / 100) + 0.5f,
                                                                          static_cast<float>(i / 10 % 10) - 4.5f));
    }
    fluid.add(positions);
    for (int i = 0; i < 90; ++i) fluid.step({}, kFrame);
    const double height = layers * settings.spacing;
    EXPECT_NEAR(meanHeight(fluid), 0.5 * height, 0.03 * 0.5 * height) << layers;
    double highest = 0.0, speed = 0.0;
    for (const Vec3f& p : fluid.positions()) highest = std::max(highest, static_cast<double>(p.y()));
    for (const Vec3f& v : fluid.velocities()) speed += v.norm() / static_cast<double>(fluid.size());
    EXPECT_LT(highest, 1.05 * height) << "nothing is thrown up";
    EXPECT_LT(speed, 0.15) << layers << ": it boils";
  }
}

TEST(Fluid, WithoutForcesMomentumIsKept) {
  FluidSettings settings;
  settings.capacity = 1000;
  settings.gravity = Vec3::Zero();
  settings.floor = false;
  Fluid fluid = Fluid::create(settings).value();
  std::vector<Vec3f> positions;
  for (int i = 0; i < 1000; ++i) {  // too dense: it bursts
    positions.emplace_back(0.016f * static_cast<float>(i % 10), 1.0f + 0.016f * static_cast<float>(i / 10 % 10),
                           0.016f * static_cast<float>(i / 100));
  }
  fluid.add(positions, Vec3(1.0, 0.0, 0.5));
  for (int i = 0; i < 10; ++i) fluid.step({}, kFrame);
  Vec3 mean = Vec3::Zero();
  double spread = 0.0;
  for (const Vec3f& v : fluid.velocities()) mean += v.cast<double>() / 1000.0;
  for (const Vec3f& v : fluid.velocities()) spread += (v.cast<double>() - mean).norm() / 1000.0;
  EXPECT_LT((mean - Vec3(1.0, 0.0, 0.5)).norm(), 0.01);
  EXPECT_GT(spread, 0.02) << "it did burst";
}

TEST(Fluid, APartPushesItAndHoldsNoneInside) {
  Fluid fluid = dam(10, 8);
  LivePart leg = makeBoxPart(Vec3(0.06, 0.3, 0.06), at(0.0, 0.31, 0.9));
  for (int frame = 0; frame < 30; ++frame) {
    moveTo(leg, at(0.0, 0.31, 0.9 - 0.05 * frame));
    fluid.step({&leg, 1}, kFrame);
    for (const Vec3f& p : fluid.positions()) {
      const Vec3 own = (leg.worldFromPart.inverse() * p.cast<double>()).cwiseAbs();
      const double in = std::min({0.06 - own.x(), 0.3 - own.y(), 0.06 - own.z()});
      EXPECT_LT(in, -0.5 * kSpacing + 1e-3);
      EXPECT_GE(p.y(), 0.5f * kSpacing - 1e-6f);
    }
  }
}

std::vector<Vec3f> positions(int threads) {
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  Fluid fluid = dam(12, 16);
  for (int i = 0; i < 8; ++i) fluid.step({}, kFrame);
  return {fluid.positions().begin(), fluid.positions().end()};
}

TEST(Fluid, ThreadsAndInstructionSetsChangeNoBit) {
  const std::vector<Vec3f> one = positions(1);
  EXPECT_EQ(one, positions(4));
  onEveryInstructionSet([&] { EXPECT_EQ(one, positions(2)); });
}

TEST(Fluid, StepsAllocateNothingAfterTheFirst) {
  Fluid fluid = dam(8, 8);
  LivePart leg = makeBoxPart(Vec3(0.06, 0.3, 0.06), at(0.0, 0.31, 0.0));
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  for (int i = 0; i < 2; ++i) fluid.step({&leg, 1}, kFrame);
  const long before = allocationCount();
  ASSERT_GT(before, 0);
  for (int i = 0; i < 5; ++i) fluid.step({&leg, 1}, kFrame);
  EXPECT_EQ(allocationCount() - before, 0);
}

TEST(Fluid, ParticlesInOnePositionSeparate) {
  FluidSettings settings;
  settings.capacity = 40;
  Fluid fluid = Fluid::create(settings).value();
  EXPECT_EQ(fluid.add(std::vector<Vec3f>(30, Vec3f(0.0f, 0.5f, 0.0f))), 30u);
  EXPECT_EQ(fluid.add(std::vector<Vec3f>{Vec3f(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f)}), 0u);
  for (int i = 0; i < 30; ++i) fluid.step({}, kFrame);
  for (const Vec3f& p : fluid.positions()) ASSERT_TRUE(p.allFinite());
}

constexpr float kDrop = 0.02f, kFar = 1000.0f;
const Vec3f kGravity(0.0f, -9.81f, 0.0f);

/// A block of drops from a corner on.
std::vector<ParticleRow> block(const std::array<int, 3>& drops, const Vec3f& corner = Vec3f::Zero()) {
  std::vector<ParticleRow> rows;
  rows.reserve(static_cast<std::size_t>(drops[0]) * drops[1] * drops[2]);
  for (int z = 0; z < drops[2]; ++z) {
    for (int x = 0; x < drops[0]; ++x) {
      for (int y = 0; y < drops[1]; ++y) {
        const auto along = [&](int i, int axis) { return corner[axis] + kDrop * (static_cast<float>(i) + 0.5f); };
        rows.push_back({along(x, 0), along(y, 1), along(z, 2), 0.0f});
      }
    }
  }
  return rows;
}

TEST(StandingWater, APoolIsHeldUp) {
  const std::vector<ParticleRow> drops = block({15, 60, 15});
  StandingWater water(drops.size(), kDrop, Vec3f::Zero(), Vec3f(0.3f, kFar, 0.3f));
  water.find(drops, kGravity, {});
  for (std::size_t i = 0; i < drops.size(); ++i) {
    const ParticleRow lift = water.lift(i, drops[i]);
    EXPECT_NEAR(lift.x, 0.0f, 0.05f);
    EXPECT_NEAR(lift.y, 9.81f, 0.05f) << drops[i].y;
    EXPECT_NEAR(lift.z, 0.0f, 0.05f);
    EXPECT_EQ(lift.w, 1.0f);
  }
}

TEST(StandingWater, WhatFallsFreelyHasNoPressure) {
  std::vector<ParticleRow> drops = block({15, 15, 15}, Vec3f(0.3f, 1.0f, 0.3f));
  drops.push_back({-500.0f, 20.0f, 3.0f, 0.0f});
  StandingWater water(drops.size(), kDrop, Vec3f(-kFar, 0.0f, -kFar), Vec3f::Constant(kFar));
  water.find(drops, kGravity, {});
  for (std::size_t i = 0; i < drops.size(); ++i) EXPECT_EQ(water.lift(i, drops[i]).y, 0.0f);
  water.find({}, kGravity, {});
}

TEST(StandingWater, ADamIsPushedTowardsItsOpenSide) {
  const std::vector<ParticleRow> drops = block({15, 30, 15});
  StandingWater water(drops.size(), kDrop, Vec3f::Zero(), Vec3f(0.9f, kFar, 0.3f));
  water.find(drops, kGravity, {});
  for (std::size_t i = 0; i < drops.size(); ++i) {
    EXPECT_GE(water.lift(i, drops[i]).x, -0.05f);
    if (drops[i].x > 0.28f && drops[i].y < 0.1f) {
      EXPECT_GT(water.lift(i, drops[i]).x, 4.0f);
    }
    EXPECT_LT(water.lift(i, drops[i]).y, 9.86f);
  }
}

TEST(StandingWater, WallsCloserThanADropAreOneCell) {
  const std::vector<ParticleRow> drops(30, {0.0f, 0.01f, 0.0f, 0.0f});
  StandingWater water(drops.size(), kDrop, Vec3f::Zero(), Vec3f(0.0f, kFar, 0.001f));
  water.find(drops, kGravity, {});
  EXPECT_NEAR(water.lift(7, drops[7]).y, 9.81f, 1e-3f);
}

TEST(StandingWater, BesideASolidNothingIsHeld) {
  const std::vector<ParticleRow> drops = block({60, 15, 15});
  StandingWater water(drops.size(), kDrop, Vec3f::Zero(), Vec3f(1.2f, kFar, 0.3f));
  const StandingWater::Solid box{Vec3f(-0.2f, 0.2f, 0.0f), Vec3f(0.1f, 0.4f, 0.3f)};
  const StandingWater::Solid above{Vec3f(0.8f, 2.0f, 0.0f), Vec3f(1.2f, 3.0f, 0.3f)};
  const std::array<StandingWater::Solid, 2> solids = {box, above};
  water.find(drops, kGravity, solids);
  for (std::size_t i = 0; i < drops.size(); ++i) {
    const ParticleRow lift = water.lift(i, drops[i]);
    if (drops[i].x < 0.1f) {
      EXPECT_EQ(lift.w, 0.0f);
    }
    if (drops[i].x < 0.1f) {
      EXPECT_EQ(lift.y, 0.0f);
    }
    if (drops[i].x > 0.7f) {
      EXPECT_NEAR(lift.y, 9.81f, 0.05f) << "what is far above does not count";
    }
  }
}

}  // namespace
}  // namespace lorica::test
