#include "collision/particles/granular.h"

#include "collision/particles/neighbour_lists.h"
#include "collision/particles/particles.h"
#include "geometry/random_numbers.h"
#include "tests/collision/parts.h"
#include "tests/support/allocations.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

namespace lorica::test {
namespace {

constexpr double kFrame = 1.0 / 30.0;
constexpr float kRadius = 0.02f;

GranularSettings smallSettings(std::size_t capacity) {
  GranularSettings settings;
  settings.capacity = capacity;
  settings.radius = kRadius;
  return settings;
}

/// A block of nx * ny * nx grains above the floor, slightly out of line.
std::vector<Vec3f> block(int nx, int ny, const Vec3f& min) {
  RandomNumbers random(4);
  std::vector<Vec3f> positions;
  positions.reserve(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nx));
  for (int y = 0; y < ny; ++y) {
    for (int z = 0; z < nx; ++z) {
      for (int x = 0; x < nx; ++x) {
        const auto off = static_cast<float>(random.between(-4e-4, 4e-4));
        positions.push_back(min + Vec3f(static_cast<float>(x) * 2.04f * kRadius + off,
                                        static_cast<float>(y) * 2.04f * kRadius,
                                        static_cast<float>(z) * 2.04f * kRadius - off));
      }
    }
  }
  return positions;
}

/// How far a grain is inside a box-shaped part [m]; 0 or less if outside.
double depthIn(const LivePart& part, const Vec3& halfExtents, const Vec3f& position) {
  const Vec3 outside = (part.worldFromPart.inverse() * position.cast<double>()).cwiseAbs() - halfExtents;
  const double distance = outside.maxCoeff() > 0.0 ? outside.cwiseMax(0.0).norm() : outside.maxCoeff();
  return kRadius - distance;
}

TEST(Granular, FallsFreelyAsTheClosedFormSays) {
  Granular sand = Granular::create(smallSettings(1)).value();
  sand.add(std::vector<Vec3f>{Vec3f(0.3f, 2.0f, -0.1f)}, Vec3(0.5, 1.0, 0.0));
  const int frames = 9;
  for (int i = 0; i < frames; ++i) sand.step({}, kFrame);
  const double t = frames * kFrame, h = 1.0 / 240.0;
  EXPECT_NEAR(sand.positions()[0].x(), 0.3 + 0.5 * t, 1e-4);
  // Substeps add g h t / 2 to the parabola.
  EXPECT_NEAR(sand.positions()[0].y(), 2.0 + t - 0.5 * 9.81 * t * (t + h), 1e-4);
  EXPECT_NEAR(sand.positions()[0].z(), -0.1, 1e-6);
  EXPECT_NEAR(sand.velocities()[0].y(), 1.0 - 9.81 * t, 1e-3);
}

TEST(Granular, TwoGrainsThatMeetPartWithoutPassingAndLoseNoMomentumSideways) {
  GranularSettings settings = smallSettings(2);
  settings.gravity = Vec3::Zero();
  settings.floor = false;
  Granular sand = Granular::create(settings).value();
  sand.add(std::vector<Vec3f>{Vec3f(-0.1f, 1.0f, 0.0f)}, Vec3(1.0, 0.0, 0.0));
  sand.add(std::vector<Vec3f>{Vec3f(0.1f, 1.0f, 0.0f)}, Vec3(-0.5, 0.0, 0.0));
  for (int i = 0; i < 15; ++i) sand.step({}, kFrame);
  EXPECT_GT(sand.positions()[1].x() - sand.positions()[0].x(), 2.0f * kRadius - 1e-4f);
  EXPECT_NEAR(sand.velocities()[0].x() + sand.velocities()[1].x(), 0.5, 1e-3);
  EXPECT_NEAR(sand.velocities()[0].x(), 0.25, 1e-3) << "they do not bounce";
}

TEST(Granular, APouredHeapComesToRestWithASlopeAndKeepsItsVolume) {
  Granular heap = Granular::create(smallSettings(2000)).value();
  for (int i = 0; i < 150; ++i) {
    if (i < 40) heap.add(block(5, 2, Vec3f(-0.08f, 0.6f, -0.08f)), Vec3(0.0, -2.0, 0.0));
    heap.step({}, kFrame);
  }
  EXPECT_LT(heap.awakeCount(), 60u) << "nearly all grains sleep";
  const std::vector<Vec3f> before(heap.positions().begin(), heap.positions().end());
  for (int i = 0; i < 30; ++i) heap.step({}, kFrame);
  double top = 0.0, moved = 0.0, overlap = 0.0;
  std::vector<double> distances;
  std::vector<Vec3f> byX(heap.positions().begin(), heap.positions().end());
  for (std::size_t i = 0; i < heap.size(); ++i) {
    const Vec3f& p = heap.positions()[i];
    ASSERT_TRUE(p.allFinite());
    EXPECT_GE(p.y(), kRadius - 1e-6f);
    top = std::max(top, static_cast<double>(p.y()));
    moved += (p - before[i]).norm() / static_cast<double>(heap.size());
    distances.push_back(std::hypot(p.x(), p.z()));
  }
  EXPECT_LT(moved, 1e-3) << "the heap stays in place";
  std::sort(distances.begin(), distances.end());
  const double foot = distances[distances.size() * 95 / 100];
  const double slope = std::atan2(top, foot) * 180.0 / std::numbers::pi;
  EXPECT_GT(slope, 15.0) << "top " << top << " m, foot " << foot << " m";
  EXPECT_LT(slope, 60.0);
  std::sort(byX.begin(), byX.end(), [](const Vec3f& a, const Vec3f& b) { return a.x() < b.x(); });
  for (std::size_t i = 0; i < byX.size(); ++i) {
    for (std::size_t j = i + 1; j < byX.size() && byX[j].x() - byX[i].x() < 2.0f * kRadius; ++j) {
      overlap += std::max(0.0f, 2.0f * kRadius - (byX[j] - byX[i]).norm());
    }
  }
  EXPECT_LT(overlap / static_cast<double>(heap.size()), 0.2 * kRadius) << "grains keep each other apart";
}

TEST(Granular, WallsHoldAColumnThatDoesNotCollapse) {
  GranularSettings settings = smallSettings(2160);
  settings.walls = Aabb{Vec3(-0.25, 0, -0.25), Vec3(0.25, 9, 0.25)};
  Granular sand = Granular::create(settings).value();
  sand.add(block(12, 15, Vec3f(-0.22f, 0.021f, -0.22f)));
  for (int i = 0; i < 120; ++i) sand.step({}, kFrame);
  double middle = 0.0;
  for (const Vec3f& p : sand.positions()) {
    ASSERT_TRUE(p.allFinite());
    EXPECT_GE(p.y(), kRadius - 1e-6f);
    EXPECT_LE(std::abs(p.x()), 0.25f - kRadius + 1e-6f);
    EXPECT_LE(std::abs(p.z()), 0.25f - kRadius + 1e-6f);
    middle += p.y() / static_cast<double>(sand.size());
  }
  // Fraction of the space that the grains' own volume takes; randomly packed spheres take 0.55 to 0.64.
  const double filled = 2160 * 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3) / (0.25 * 2.0 * middle);
  EXPECT_GT(filled, 0.45);
  EXPECT_LT(filled, 0.75);
}

TEST(Granular, AFastHandPushesGrainsAndLeavesNoneInside) {
  Granular sand = Granular::create(smallSettings(2000)).value();
  sand.add(block(10, 8, Vec3f(-0.2f, 0.021f, -0.2f)));
  LivePart hand = makeBoxPart(Vec3(0.03, 0.08, 0.05), at(-0.6, 0.12, 0.0));
  for (int i = 0; i < 60; ++i) sand.step({&hand, 1}, kFrame);
  const std::vector<Vec3f> before(sand.positions().begin(), sand.positions().end());
  for (int frame = 1; frame <= 8; ++frame) {  // 4.5 m/s, rotating
    Isometry3 next = at(-0.6 + 0.15 * frame, 0.12, 0.0);
    next.rotate(Eigen::AngleAxisd(0.3 * frame, Vec3::UnitY()));
    moveTo(hand, next);
    sand.step({&hand, 1}, kFrame);
    for (const Vec3f& p : sand.positions()) EXPECT_LT(depthIn(hand, Vec3(0.03, 0.08, 0.05), p), 1e-3);
  }
  int pushed = 0;
  for (std::size_t i = 0; i < sand.size(); ++i) {
    EXPECT_GE(sand.positions()[i].y(), kRadius - 1e-6f);
    if (sand.positions()[i].x() - before[i].x() > 0.05f) ++pushed;
  }
  EXPECT_GT(pushed, 30);
}

TEST(Granular, AFootThatStepsOnGrainsLeavesThemNeitherInsideNorBelowTheFloor) {
  Granular sand = Granular::create(smallSettings(800)).value();
  sand.add(block(12, 3, Vec3f(-0.22f, 0.021f, -0.22f)));
  LivePart foot = makeBoxPart(Vec3(0.06, 0.04, 0.13), at(0.0, 0.3, 0.0));
  for (int frame = 0; frame <= 20; ++frame) {
    moveTo(foot, at(0.0, std::max(0.041, 0.3 - 0.02 * frame), 0.0));
    sand.step({&foot, 1}, kFrame);
    for (const Vec3f& p : sand.positions()) {
      ASSERT_TRUE(p.allFinite());
      EXPECT_GE(p.y(), kRadius - 1e-6f);
      EXPECT_LT(depthIn(foot, Vec3(0.06, 0.04, 0.13), p), 1e-3);
    }
  }
}

TEST(Granular, WhatLiesOnAPartFallsWhenItLeaves) {
  Granular sand = Granular::create(smallSettings(100)).value();
  LivePart table = makeBoxPart(Vec3(0.3, 0.05, 0.3), at(0.0, 0.5, 0.0));
  sand.add(block(4, 2, Vec3f(-0.06f, 0.58f, -0.06f)));
  for (int i = 0; i < 90; ++i) sand.step({&table, 1}, kFrame);
  EXPECT_EQ(sand.awakeCount(), 0u);
  for (const Vec3f& p : sand.positions()) EXPECT_GT(p.y(), 0.55f);
  moveTo(table, at(3.0, 0.5, 0.0));
  for (int i = 0; i < 30; ++i) {
    sand.step({&table, 1}, kFrame);
    moveTo(table, at(3.0, 0.5, 0.0));
  }
  for (const Vec3f& p : sand.positions()) EXPECT_LT(p.y(), 0.2f);
}

std::vector<Vec3f> positions(int threads) {
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  Granular sand = Granular::create(smallSettings(2000)).value();
  sand.add(block(10, 20, Vec3f(-0.2f, 0.021f, -0.2f)));
  LivePart hand = makeBoxPart(Vec3(0.05, 0.08, 0.05), at(-0.4, 0.12, 0.0));
  for (int frame = 0; frame < 10; ++frame) {
    moveTo(hand, at(-0.4 + 0.05 * frame, 0.12, 0.0));
    sand.step({&hand, 1}, kFrame);
  }
  return {sand.positions().begin(), sand.positions().end()};
}

TEST(Granular, ThreadsAndInstructionSetsChangeNoBit) {
  const std::vector<Vec3f> one = positions(1);
  EXPECT_EQ(one, positions(4));
  onEveryInstructionSet([&] { EXPECT_EQ(one, positions(2)); });
}

TEST(Granular, StepsAllocateNothingAfterTheFirst) {
  Granular sand = Granular::create(smallSettings(1000)).value();
  sand.add(block(10, 5, Vec3f(-0.2f, 0.021f, -0.2f)));
  LivePart hand = makeBoxPart(Vec3(0.05, 0.08, 0.05), at(-0.1, 0.12, 0.0));
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<Vec3f> more = block(5, 1, Vec3f(-0.1f, 0.9f, -0.1f));
  for (int i = 0; i < 2; ++i) sand.step({&hand, 1}, kFrame);
  const long before = allocationCount();
  ASSERT_GT(before, 0);
  for (int i = 0; i < 10; ++i) {
    sand.add(more);
    sand.step({&hand, 1}, kFrame);
  }
  EXPECT_EQ(allocationCount() - before, 0);
}

TEST(Granular, NonFiniteAndDistantPositionsDoNoHarm) {
  Granular sand = Granular::create(smallSettings(50)).value();
  const float none = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3f> given{Vec3f(none, 1.0f, 0.0f), Vec3f(0.0f, 1.0f, 0.0f), Vec3f(0.0f, 1.0f, 0.0f),
                                 Vec3f(900.0f, 1.0f, -900.0f), Vec3f(0.0f, 1.0f, 0.01f)};
  EXPECT_EQ(sand.add(given), 4u);
  LivePart broken = makeBoxPart(Vec3(0.1, 0.1, 0.1), at(0.0, 0.5, 0.0));
  broken.worldFromPart.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < 40; ++i) sand.step({&broken, 1}, kFrame);
  for (const Vec3f& p : sand.positions()) {
    ASSERT_TRUE(p.allFinite());
    EXPECT_NEAR(p.y(), kRadius, 0.1f);
  }
  EXPECT_GT((sand.positions()[0] - sand.positions()[1]).norm(), kRadius) << "grains in one position separate";
  EXPECT_EQ(sand.add(std::vector<Vec3f>(60, Vec3f(0.0f, 3.0f, 0.0f))), 46u) << "the capacity allows this many";
}

/// A block of sand that falls from 20 cm and settles for half a second: 15 frames.
ParticleSettings fallingSand() {
  ParticleSettings settings;
  settings.radius = 0.02;
  settings.fills.push_back({Vec3(0.0, 0.4, 0.0), Vec3(0.4, 0.4, 0.4)});
  settings.settleSeconds = 0.5;
  return settings;
}

bool sameBits(const Particles& a, const Particles& b) {
  return std::equal(a.positions().begin(), a.positions().end(), b.positions().begin(), b.positions().end());
}

TEST(Settling, ParticlesThatHaveSettledBeforeTheFirstStepMoveAsIfTheySettledInIt) {
  Particles inStep = Particles::create(fallingSand()).value(), before = Particles::create(fallingSand()).value();
  EXPECT_FALSE(before.settled());
  EXPECT_TRUE(before.settle({}));
  EXPECT_TRUE(before.settled());
  const double lowest = 0.2;
  EXPECT_TRUE(std::any_of(before.positions().begin(), before.positions().end(), [&](const Vec3f& p) {
    return p.y() < 0.5 * lowest;
  })) << "it has fallen";
  for (int frame = 0; frame < 3; ++frame) {
    inStep.step({}, 1.0 / 30.0);
    before.step({}, 1.0 / 30.0);
    EXPECT_TRUE(sameBits(inStep, before)) << frame;
  }
}

TEST(Settling, WhoWatchesIsToldOfEachFrameAndCanStopIt) {
  Particles particles = Particles::create(fallingSand()).value();
  std::vector<int> frames;
  particles.watchSettling([&](int frame, int count) {
    EXPECT_EQ(count, 15);
    frames.push_back(frame);
    return frame < 3;
  });
  EXPECT_FALSE(particles.settle({}));
  EXPECT_EQ(frames, (std::vector<int>{1, 2, 3}));
}

struct Case {
  std::size_t count;
  double extent, height, stray;
};

/// The lists, by the particles' original indices.
std::vector<std::set<std::uint32_t>> listed(const std::vector<ParticleRow>& positions, float radius) {
  ParticleGrid grid(positions.size());
  grid.sort(positions, radius);
  std::vector<float> x(paddedCount(positions.size())), y(x.size()), z(x.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const ParticleRow& position = positions[grid.order()[i]];
    x[i] = position.x;
    y[i] = position.y;
    z[i] = position.z;
  }
  NeighbourLists lists(positions.size(), 96);
  lists.build(grid, x.data(), y.data(), z.data(), positions.size(), radius, std::vector<std::uint8_t>(x.size()));
  std::vector<std::set<std::uint32_t>> result(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::size_t block = i / kParticleBlock;
    for (int s = 0; s < lists.slotCount(block); ++s) {
      const std::uint32_t other = lists.slots(block)[static_cast<std::size_t>(s) * kParticleBlock + i % kParticleBlock];
      if (other == i) continue;
      EXPECT_TRUE(result[grid.order()[i]].insert(grid.order()[other]).second) << "listed twice";
    }
  }
  return result;
}

TEST(NeighbourLists, HoldWhatComparingAllPairsFinds) {
  RandomNumbers random(9);
  const float radius = 0.05f;
  for (const Case& c : {Case{1, 1, 1, 0}, Case{15, 0.1, 0.1, 0}, Case{16, 0.1, 0.1, 0}, Case{17, 0.1, 0.1, 0},
                        Case{700, 0.5, 0.4, 0}, Case{700, 0.5, 0.4, 60.0}, Case{300, 0.1, 12.0, 0}}) {
    std::vector<ParticleRow> positions;
    for (std::size_t i = 0; i < c.count; ++i) {
      const bool stray = i % 50 == 49;
      const double extent = stray ? c.extent + c.stray : c.extent, height = stray ? c.height + c.stray : c.height;
      positions.push_back({static_cast<float>(random.between(-extent, extent)),
                           static_cast<float>(random.between(0.0, height)),
                           static_cast<float>(random.between(-extent, extent)), 0.0f});
    }
    std::vector<std::set<std::uint32_t>> truth(positions.size());
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      for (std::uint32_t j = 0; j < positions.size(); ++j) {
        const float dx = positions[j].x - positions[i].x, dy = positions[j].y - positions[i].y,
                    dz = positions[j].z - positions[i].z;
        if (i != j && dx * dx + dy * dy + dz * dz < radius * radius) truth[i].insert(j);
      }
    }
    onEveryInstructionSet([&] { EXPECT_EQ(listed(positions, radius), truth) << c.count << " particles"; });
  }
}

TEST(NeighbourLists, OfWhatIsPressedTogetherSoManyAreLookedAt) {
  // A clump at the lower end of a cell, and two particles at its upper end, too far away from it.
  std::vector<ParticleRow> positions(NeighbourLists::kMaxLooked - 2, ParticleRow{0.001f, 0.001f, 0.001f, 0.0f});
  positions.insert(positions.end(), 2, ParticleRow{0.049f, 0.049f, 0.049f, 0.0f});
  const auto upper = [&] { return listed(positions, 0.05f).back().size(); };
  EXPECT_EQ(upper(), 1u);
  positions.insert(positions.begin(), positions.front());
  EXPECT_EQ(upper(), 1u) << "the first of the two is the last that is looked at";
  positions.insert(positions.begin(), positions.front());
  EXPECT_EQ(upper(), 0u);
}

}  // namespace
}  // namespace lorica::test
