#include "collision/particles/standing_water.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica::test {
namespace {

constexpr float kSpacing = 0.02f, kFar = 1000.0f;
const Vec3f kGravity(0.0f, -9.81f, 0.0f);

/// A block of drops from a corner on.
std::vector<ParticleRow> block(const std::array<int, 3>& drops, const Vec3f& corner = Vec3f::Zero()) {
  std::vector<ParticleRow> rows;
  rows.reserve(static_cast<std::size_t>(drops[0]) * drops[1] * drops[2]);
  for (int z = 0; z < drops[2]; ++z) {
    for (int x = 0; x < drops[0]; ++x) {
      for (int y = 0; y < drops[1]; ++y) {
        const auto along = [&](int i, int axis) { return corner[axis] + kSpacing * (static_cast<float>(i) + 0.5f); };
        rows.push_back({along(x, 0), along(y, 1), along(z, 2), 0.0f});
      }
    }
  }
  return rows;
}

TEST(StandingWater, APoolIsHeldUp) {
  const std::vector<ParticleRow> drops = block({15, 60, 15});
  StandingWater water(drops.size(), kSpacing, Vec3f::Zero(), Vec3f(0.3f, kFar, 0.3f));
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
  StandingWater water(drops.size(), kSpacing, Vec3f(-kFar, 0.0f, -kFar), Vec3f::Constant(kFar));
  water.find(drops, kGravity, {});
  for (std::size_t i = 0; i < drops.size(); ++i) EXPECT_EQ(water.lift(i, drops[i]).y, 0.0f);
  water.find({}, kGravity, {});
}

TEST(StandingWater, ADamIsPushedTowardsItsOpenSide) {
  const std::vector<ParticleRow> drops = block({15, 30, 15});
  StandingWater water(drops.size(), kSpacing, Vec3f::Zero(), Vec3f(0.9f, kFar, 0.3f));
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
  StandingWater water(drops.size(), kSpacing, Vec3f::Zero(), Vec3f(0.0f, kFar, 0.001f));
  water.find(drops, kGravity, {});
  EXPECT_NEAR(water.lift(7, drops[7]).y, 9.81f, 1e-3f);
}

TEST(StandingWater, BesideASolidNothingIsHeld) {
  const std::vector<ParticleRow> drops = block({60, 15, 15});
  StandingWater water(drops.size(), kSpacing, Vec3f::Zero(), Vec3f(1.2f, kFar, 0.3f));
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
