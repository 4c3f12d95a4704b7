#include "acd/decomposition_file.h"
#include "collision/live/lifted_kernel.h"

#include "collision/live/lifted_part.h"
#include "collision/live/lifted_point.h"
#include "collision/live/live_part.h"
#include "collision/live/part_bones.h"
#include "collision/live/rigid_fit.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/collision/parts.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numbers>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;
using test::moveTo;
using test::uniform;
using test::uniformRotation;
using test::uniformVec3;

TEST(LiftedPoint, IsWhereSkinningAndTheRecursionPutIt) {
  test::Dancer dancer;
  const std::vector<LiftedPoint> lifted = liftPoints(dancer.character, dancer.decomposition);
  ASSERT_EQ(lifted.size(), static_cast<std::size_t>(dancer.decomposition.pointCount()));
  std::mt19937_64 random(21);
  for (int frame = 0; frame < 5; ++frame) {
    dancer.dance(random, 1.5);
    const std::vector<Vec3> truth = dancer.points();
    for (std::size_t i = 0; i < lifted.size(); ++i) {
      ASSERT_LT((positionOf(lifted[i], dancer.worldFromModel) - truth[i]).norm(), 1e-12) << "point " << i;
    }
  }
  for (const LiftedPoint& point : lifted) {
    double weight = 0.0;
    for (const LiftedTerm& t : point) weight += t.weight;
    EXPECT_NEAR(weight, 1.0, 1e-9);
    EXPECT_TRUE(std::is_sorted(point.begin(), point.end(),
                               [](const LiftedTerm& a, const LiftedTerm& b) { return a.joint < b.joint; }));
  }
}

/// Random points over a few bones: some rigid, some blended; `count` of them.
std::vector<LiftedPoint> randomPoints(std::mt19937_64& random, std::size_t count) {
  std::vector<LiftedPoint> points(count);
  for (LiftedPoint& point : points) {
    const auto first = static_cast<JointIndex>(test::uniform(random, 0.0, 3.0));
    const auto bones = 1 + static_cast<JointIndex>(test::uniform(random, 0.0, 3.0));
    for (JointIndex j = first; j < first + bones; ++j) {
      point.push_back({j, test::uniformVec3(random, -0.3, 0.3) / bones, 1.0 / bones});
    }
  }
  return points;
}

std::vector<Affine3> randomBones(std::mt19937_64& random) {
  std::vector<Affine3> bones(6);
  for (Affine3& b : bones) {
    b = Eigen::Translation3d(test::uniformVec3(random, -0.1, 0.1)) * test::uniformRotation(random);
  }
  return bones;
}

/// The pose of the part's own frame.
Isometry3 positionOf(const LiftedPart& part, std::span<const Affine3> worldFromModel) {
  const LiftedPart::Moments moments = part.momentsOf(worldFromModel);
  Isometry3 worldFromPart = Isometry3::Identity();
  worldFromPart.linear() = fitRotation(moments.covariance, Mat3::Identity());
  worldFromPart.translation() = moments.mean;
  return worldFromPart;
}

TEST(LiftedPart, IsTheScalarReferenceForAnyNumberOfPointsOnEveryInstructionSet) {
  constexpr double kTick = 0x1p-21;
  std::mt19937_64 random(22);
  for (const std::size_t count : {1u, 2u, 7u, 8u, 9u, 15u, 16u, 17u, 31u, 32u, 33u, 100u, 257u}) {
    SCOPED_TRACE(count);
    const std::vector<LiftedPoint> points = randomPoints(random, count);
    const std::vector<Affine3> bones = randomBones(random);
    test::onEveryInstructionSet([&] {
      const LiftedPart part(points);
      const Isometry3 worldFromPart = positionOf(part, bones);
      LiftedPart::TakenPose taken = part.noPose();
      ASSERT_TRUE(part.take(bones, worldFromPart, kTick, taken));
      ASSERT_FALSE(part.take(bones, worldFromPart, kTick, taken)) << "the same pose again does not count as moved";
      std::vector<PointRow> rows(part.rowCount());
      const float largest = part.evaluate(taken, rows);
      Vec3 mean = Vec3::Zero();
      float seen = 0.0f;
      std::vector<int> times(count, 0);
      for (std::size_t r = 0; r < part.pointCount(); ++r) {
        const auto i = static_cast<std::size_t>(part.order()[r]);
        ++times[i];
        const Vec3 truth = positionOf(points[i], bones);
        const Vec3 row(rows[r].x, rows[r].y, rows[r].z);
        EXPECT_LT((worldFromPart * (kTick * row) - truth).norm(), 3.0 * kTick);
        EXPECT_EQ(row, row.array().round().matrix());
        mean += truth / static_cast<double>(count);
        seen = std::max(seen, static_cast<float>(row.cwiseAbs().maxCoeff()));
      }
      EXPECT_EQ(std::count(times.begin(), times.end(), 1), static_cast<std::ptrdiff_t>(count)) << "each point once";
      EXPECT_EQ(largest, seen);
      EXPECT_LT((worldFromPart.translation() - mean).norm(), 1e-12);
    });
  }
}

TEST(LiftedPart, AddsTheShapesThatHaveWeightWhetherFewOrMany) {
  constexpr double kTick = 0x1p-21;
  constexpr JointIndex kBones = 6, kShapes = 80;
  std::mt19937_64 random(28);
  std::vector<LiftedPoint> points = randomPoints(random, 100);
  std::vector<JointIndex> carriers(kBones + kShapes, kNoJoint);
  for (JointIndex s = 0; s < kShapes; ++s) carriers[kBones + s] = s % kBones;
  for (std::size_t i = 0; i < points.size(); i += 1 + i % 2) {  // others have none
    const std::size_t bones = points[i].size();
    for (JointIndex s = 0; s < kShapes; ++s) {
      const auto carrier = std::find_if(points[i].begin(), points[i].begin() + bones,
                                        [&](const LiftedTerm& t) { return t.joint == s % kBones; });
      if (carrier == points[i].begin() + bones) continue;
      const Vec3 offset = test::uniformVec3(random, -0.02, 0.02);
      carrier->moment -= offset;
      points[i].push_back({kBones + s, offset, 0.0});
    }
  }
  const LiftedPart part(points, carriers);
  for (const int moving : {0, 1, 3, 80}) {
    SCOPED_TRACE(moving);
    std::vector<Affine3> bones = randomBones(random);
    for (JointIndex s = 0; s < kShapes; ++s) {
      const double weight = s * moving % kShapes < moving ? test::uniform(random, -1.0, 1.0) : 0.0;
      bones.push_back(bones[s % kBones] * Eigen::Scaling(1.0 + weight));
    }
    test::onEveryInstructionSet([&] {
      const Isometry3 worldFromPart = positionOf(part, bones);
      LiftedPart::TakenPose taken = part.noPose();
      ASSERT_TRUE(part.take(bones, worldFromPart, kTick, taken));
      std::vector<PointRow> rows(part.rowCount());
      ASSERT_GT(part.evaluate(taken, rows), 0.0F);
      for (std::size_t r = 0; r < part.pointCount(); ++r) {
        const Vec3 truth = positionOf(points[part.order()[r]], bones);
        const Vec3 row(rows[r].x, rows[r].y, rows[r].z);
        EXPECT_LT((worldFromPart * (kTick * row) - truth).norm(), 5.0 * kTick);
      }
    });
  }
}

TEST(LiftedPart, SeesAndSumsItsBonesTheSameOnEveryInstructionSet) {
  std::mt19937_64 random(25);
  const std::vector<LiftedPoint> points = randomPoints(random, 100);
  const std::vector<Affine3> bones = randomBones(random);
  const LiftedPart part(points);
  const LiftedPart::Moments moments = part.momentsOf(bones);
  const Isometry3 worldFromPart = positionOf(part, bones);
  LiftedPart::TakenPose taken = part.noPose();
  ASSERT_TRUE(part.take(bones, worldFromPart, 0x1p-21, taken));
  std::vector<PointRow> rows(part.rowCount()), same(part.rowCount());
  const float largest = part.evaluate(taken, rows);
  test::onEveryInstructionSet([&] {
    EXPECT_EQ(part.evaluate(taken, same), largest);
    EXPECT_EQ(std::memcmp(same.data(), rows.data(), rows.size() * sizeof(PointRow)), 0);
    EXPECT_EQ(part.momentsOf(bones).mean, moments.mean);
    EXPECT_EQ(part.momentsOf(bones).covariance, moments.covariance);
    LiftedPart::TakenPose again = part.noPose();
    ASSERT_TRUE(part.take(bones, worldFromPart, 0x1p-21, again));
    for (std::size_t b = 0; b < taken.size(); ++b) EXPECT_EQ(again[b].column, taken[b].column);
  });
}

TEST(LiftedPart, TakesAPoseThatMovesAnyPointAndNoOther) {
  constexpr double kTick = 0x1p-21;
  std::mt19937_64 random(26);
  const std::vector<LiftedPoint> points = randomPoints(random, 40);
  const std::vector<Affine3> bones = randomBones(random);
  const LiftedPart part(points);
  const Isometry3 worldFromPart = positionOf(part, bones);
  test::onEveryInstructionSet([&] {
    for (std::size_t b = 0; b < 5; ++b) {
      LiftedPart::TakenPose taken = part.noPose();
      ASSERT_TRUE(part.take(bones, worldFromPart, kTick, taken));
      const LiftedPart::TakenPose before = taken;
      std::vector<Affine3> moved = bones;
      moved[b].translation().z() += 1e-3 * kTick;
      EXPECT_FALSE(part.take(moved, worldFromPart, kTick, taken));
      EXPECT_EQ(taken[0].column, before[0].column);
      moved[b].translation().z() += 2.0 * kTick;
      EXPECT_TRUE(part.take(moved, worldFromPart, kTick, taken)) << "bone " << b;
      moved[b].translation().z() = std::numeric_limits<double>::quiet_NaN();
      EXPECT_TRUE(part.take(moved, worldFromPart, kTick, taken));
      EXPECT_TRUE(part.take(moved, worldFromPart, kTick, taken)) << "NaN always counts as moved";
    }
  });
}

TEST(LiftedPart, PlacesItselfAsAFitOfAllPointsWould) {
  test::Dancer dancer;
  const std::vector<LiftedPoint> lifted = liftPoints(dancer.character, dancer.decomposition);
  std::mt19937_64 random(23);
  for (const Part& decomposed : dancer.decomposition.parts) {
    std::vector<LiftedPoint> own;
    std::vector<Vec3> bind;
    Vec3 mean = Vec3::Zero();
    for (const PointIndex p : decomposed.points) {
      own.push_back(lifted[p]);
      bind.push_back(bindPositionOf(own.back()));
      mean += bind.back() / static_cast<double>(decomposed.points.size());
    }
    for (Vec3& p : bind) p -= mean;
    LiftedPart part(own);
    dancer.dance(random, 1.0);
    std::vector<Vec3> posed;
    posed.reserve(own.size());
    for (const LiftedPoint& p : own) posed.push_back(positionOf(p, dancer.worldFromModel));
    const Isometry3 truth = fitRigidMotion(bind, posed, Mat3::Identity());
    EXPECT_LT((positionOf(part, dancer.worldFromModel).matrix() - truth.matrix()).norm(), 1e-9);
  }
}

TEST(HullCandidates, LeaveOutWhatIsInsideInEveryPoseAndNothingElse) {
  // A cube of one bone with a point in the middle and one in the middle of an edge: neither can ever be on the hull.
  // The same middle point moved by two bones can.
  Decomposition decomposition;
  decomposition.vertexCount = 11;
  decomposition.parts.resize(1);
  std::vector<LiftedPoint> lifted;
  for (int i = 0; i < 8; ++i) lifted.push_back({{0, Vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1), 1.0}});
  lifted.push_back({{0, Vec3::Constant(0.5), 1.0}});
  lifted.push_back({{0, Vec3(0.5, 0.0, 0.0), 1.0}});
  lifted.push_back({{0, Vec3::Constant(0.25), 0.5}, {1, Vec3::Constant(0.25), 0.5}});
  for (PointIndex p = 0; p < 11; ++p) decomposition.parts[0].points.push_back(p);
  // Also a cut point between two corners of the part.
  decomposition.cutPoints.push_back({0, 7, 0.25});
  lifted.push_back({{0, Vec3::Constant(0.75), 1.0}});
  decomposition.parts[0].points.push_back(11);
  EXPECT_EQ(hullCandidates(decomposition, decomposition.parts[0], lifted),
            (std::vector<PointIndex>{0, 1, 2, 3, 4, 5, 6, 7, 10}));
}

TEST(FarthestRow, IsTheFirstOfTheFarthestOnEveryInstructionSet) {
  std::mt19937_64 random(24);
  for (const std::size_t count : {1u, 3u, 15u, 16u, 17u, 33u, 200u}) {
    std::vector<PointRow> rows(count);
    for (PointRow& r : rows) {  // few different coordinates, so that many are equally far
      const Vec3 p = (3.0 * test::uniformVec3(random, -1.0, 1.0)).array().round();
      r = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0.0f};
    }
    for (int k = 0; k < 30; ++k) {
      const Vec3f direction = (2.0 * test::uniformVec3(random, -1.0, 1.0)).array().round().cast<float>();
      std::int32_t truth = 0;
      const auto along = [&](std::size_t i) {
        return (direction.x() * rows[i].x + direction.y() * rows[i].y) + direction.z() * rows[i].z;
      };
      for (std::size_t i = 1; i < count; ++i) {
        if (along(i) > along(static_cast<std::size_t>(truth))) truth = static_cast<std::int32_t>(i);
      }
      test::onEveryInstructionSet([&] { EXPECT_EQ(farthestRow(rows, direction), truth) << count << " rows"; });
    }
  }
}

constexpr double kFrame = 1.0 / 30.0;

Isometry3 randomPosition(std::mt19937_64& random) {
  return Eigen::Translation3d(uniformVec3(random, -2.0, 2.0)) * uniformRotation(random);
}

/// A rotation about an axis through the origin of the part, and a shift: both in world axes.
Isometry3 movedBy(const Isometry3& pose, const Vec3& axis, double angle, const Vec3& shift) {
  Isometry3 next = pose;
  next.linear() = Eigen::AngleAxisd(angle, axis) * pose.linear();
  next.translation() += shift;
  return next;
}

TEST(LivePart, AStillPartHasNoVelocity) {
  std::mt19937_64 random(1);
  LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
  moveTo(part, part.worldFromPart);
  for (int i = 0; i < 100; ++i) EXPECT_LT(velocityAt(part, uniformVec3(random, -3.0, 3.0), kFrame).norm(), 1e-12);
}

TEST(LivePart, SmallTurnsGiveVPlusOmegaCrossR) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 200; ++i) {
    LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
    const Vec3 velocity = uniformVec3(random, -5.0, 5.0);
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    const double angle = 1e-5;
    const Vec3 omega = angle / kFrame * axis;
    moveTo(part, movedBy(part.worldFromPart, axis, angle, kFrame * velocity));
    const Vec3 point = part.worldFromPart * uniformVec3(random, -0.5, 0.5);
    const Vec3 expected = velocity + omega.cross(Vec3(point - part.worldFromPart.translation()));
    // The chord differs from the tangent by half the squared angle times the distance: 1e-10 / 2 * 0.9 m per frame.
    EXPECT_LT((velocityAt(part, point, kFrame) - expected).norm(), 1e-10 / kFrame) << "case " << i;
  }
}

TEST(LivePart, LargeTurnsGiveThePathOfTheMaterialOverTheFrame) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
    const Isometry3 before = part.worldFromPart;
    const Isometry3 after = randomPosition(random);
    moveTo(part, after);
    const Vec3 own = uniformVec3(random, -0.5, 0.5);
    const double seconds = uniform(random, 0.001, 0.1);
    const Vec3 expected = (after * own - before * own) / seconds;
    EXPECT_LT((velocityAt(part, after * own, seconds) - expected).norm(), 1e-9 / seconds) << "case " << i;
  }
}

TEST(LivePart, TheWorldHullIsTheShapeInItsPose) {
  std::mt19937_64 random(4);
  const LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
  const ConvexHull hull = worldHull(part);
  ASSERT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.triangles, part.shape.triangles);
  EXPECT_EQ(hull.pointOfVertex, part.shape.pointOfVertex);
  EXPECT_EQ(hull.volume, part.shape.volume);
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3 own = part.worldFromPart.linear().transpose() * (hull.vertices[v] - part.worldFromPart.translation());
    EXPECT_LT((own.cwiseAbs() - Vec3(0.1, 0.2, 0.3)).norm(), 1e-12);
  }
}

TEST(LivePart, WhatStandsStillSweepsItself) {
  std::mt19937_64 random(5);
  LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
  moveTo(part, part.worldFromPart);
  const ConvexHull swept = sweptHull(part);
  EXPECT_NEAR(swept.volume, 8 * 0.1 * 0.2 * 0.3, 1e-12);
}

TEST(LivePart, ASweptBoxIsALongerBox) {
  LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), at(1, 2, 3));
  moveTo(part, at(1.5, 2, 3));
  EXPECT_NEAR(sweptHull(part).volume, (0.2 + 0.5) * 0.4 * 0.6, 1e-12);
}

TEST(LivePart, ASweptBallIsACapsule) {
  const double radius = 0.1;
  const double length = 0.5;
  LivePart part = makeBoxPart(Vec3::Constant(0.1), at(0, 1, 0));
  const int rings = 60;
  const int segments = 90;
  test::reshape(part, test::makeSphere(radius, rings, segments).vertices);
  part.reshaped = false;
  const auto capsule = [&](double r) {
    return std::numbers::pi * r * r * (length + 4.0 / 3.0 * r);  // cylinder, and a ball cut in two
  };
  // The points are on the ball. Their hull contains the ball that is smaller by the sagitta of the widest gap.
  const double gap = std::hypot(0.5 * std::numbers::pi / rings, std::numbers::pi / segments);
  std::mt19937_64 random(6);
  for (int i = 0; i < 20; ++i) {
    const Vec3 direction = uniformRotation(random) * Vec3::UnitX();
    moveTo(part, Eigen::Translation3d(length * direction) * part.worldFromPart);
    const double volume = sweptHull(part).volume;
    EXPECT_LE(volume, capsule(radius));
    EXPECT_GE(volume, capsule(radius * std::cos(gap)));
  }
}

TEST(LivePart, TheSweptHullHoldsBothEndsThoughTheShapeChanged) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 100; ++i) {
    LivePart part = makeBoxPart(uniformVec3(random, 0.02, 0.3), randomPosition(random));
    const ConvexHull before = worldHull(part);
    moveTo(part, movedBy(part.worldFromPart, uniformRotation(random) * Vec3::UnitX(), uniform(random, 0.0, 1.0),
                         uniformVec3(random, -0.3, 0.3)));
    part.reshaped = false;
    if (i % 2 == 0) test::reshapeToBox(part, uniformVec3(random, 0.02, 0.3));
    const ConvexHull swept = sweptHull(part);
    std::vector<Vec3> points;
    sweptPoints(part, points);
    EXPECT_EQ(points.size(), before.vertices.size() + part.shape.vertices.size());
    EXPECT_EQ(convexHull(points).vertices, swept.vertices);
    EXPECT_LT(largestViolation(swept, before.vertices), 1e-9) << "case " << i;
    EXPECT_LT(largestViolation(swept, worldHull(part).vertices), 1e-9) << "case " << i;
  }
}

TEST(LivePart, ItsVelocityTakesThePreviousFrameToThePresentOne) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 1000; ++i) {
    LivePart part = makeBoxPart(uniformVec3(random, 0.02, 0.3), randomPosition(random));
    const double angle = uniform(random, 0.0, i % 10 == 0 ? 1e-7 : 3.1);
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    moveTo(part, movedBy(part.worldFromPart, axis, angle, uniformVec3(random, -0.3, 0.3)));
    const double seconds = uniform(random, 0.001, 0.1);
    const PartVelocity velocity = velocityOf(part, seconds);
    EXPECT_LT((seconds * velocity.angular - angle * axis).norm(), 1e-8) << "case " << i;
    const Vec3 origin = part.worldFromPart.translation();
    EXPECT_LT((velocity.linear - velocityAt(part, origin, seconds)).norm(), 1e-9 / seconds) << "case " << i;
  }
  const PartVelocity rest = velocityOf(makeBoxPart(Vec3(0.1, 0.2, 0.3), at(0, 1, 0)), 0.01);
  EXPECT_EQ(rest.linear, Vec3::Zero());
  EXPECT_EQ(rest.angular, Vec3::Zero());
}

TEST(LivePart, TheFirstFrameSweepsNoEarlierShape) {
  LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), at(0, 1, 0));
  ASSERT_TRUE(part.reshaped);
  ASSERT_TRUE(part.previousVertices.empty());
  EXPECT_NEAR(sweptHull(part).volume, part.shape.volume, 1e-12);
}

/// Max distance by which the path of a rotating part protrudes from its swept hull.
double stickingOut(const LivePart& part, const Vec3& axis, double angle, const Vec3& shift) {
  const ConvexHull swept = sweptHull(part);
  double worst = 0.0;
  for (int k = 0; k <= 40; ++k) {
    const double t = k / 40.0;
    const Isometry3 pose = movedBy(part.previousWorldFromPart, axis, t * angle, t * shift);
    std::vector<Vec3> points;
    points.reserve(part.shape.vertices.size());
    for (const Vec3& v : part.shape.vertices) points.push_back(pose * v);
    worst = std::max(worst, largestViolation(swept, points));
  }
  return worst;
}

TEST(LivePart, ATurnLeavesTheSweptHullByItsSagittaAtMost) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 200; ++i) {
    const Vec3 half = uniformVec3(random, 0.02, 0.3);
    LivePart part = makeBoxPart(half, randomPosition(random));
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    const double angle = uniform(random, 0.0, std::numbers::pi);
    const Vec3 shift = uniformVec3(random, -0.5, 0.5);
    moveTo(part, movedBy(part.worldFromPart, axis, angle, shift));
    EXPECT_LE(stickingOut(part, axis, angle, shift), half.norm() * (1.0 - std::cos(0.5 * angle)) + 1e-9)
        << "case " << i;
  }
}

TEST(LivePart, TheSagittaOfAThinRodIsReached) {
  for (const double angle : {0.1, 0.5, 1.0, 2.0}) {
    LivePart rod = makeBoxPart(Vec3(0.5, 0.001, 0.001), at(0, 1, 0));
    moveTo(rod, movedBy(rod.worldFromPart, Vec3::UnitY(), angle, Vec3::Zero()));
    const double sagitta = 0.5 * (1.0 - std::cos(0.5 * angle));
    EXPECT_GT(stickingOut(rod, Vec3::UnitY(), angle, Vec3::Zero()), sagitta - 0.001) << angle;
  }
}

/// A bar of 4 x 1 x 1 along x, from -2 to 2: vertices with x < 0 move with "left", the others with "right".
Character bar() {
  Character character;
  character.name = "bar";
  character.mesh = test::makeBox({-2, 0, 0}, {2, 1, 1});
  std::vector<Joint> joints(3);
  joints[0].name = "root";
  joints[1].name = "left";
  joints[2].name = "right";
  joints[1].parent = joints[2].parent = 0;
  character.skeleton = Skeleton::create(joints).value();
  character.jointFromModel.resize(3, Affine3::Identity());
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    character.influenceBegin.push_back(static_cast<std::uint32_t>(v));
    character.influences.push_back({character.mesh.vertices[v].x() < 0.0 ? 1 : 2, 1.0});
  }
  character.influenceBegin.push_back(static_cast<std::uint32_t>(character.mesh.vertices.size()));
  return character;
}

std::map<std::string, double> byName(const std::vector<BoneShare>& bones) {
  std::map<std::string, double> shares;
  for (const BoneShare& bone : bones) shares[bone.bone] = bone.share;
  return shares;
}

Decomposition wholeOf(const TriMesh& mesh) {
  Decomposition whole;
  whole.vertexCount = static_cast<int>(mesh.vertices.size());
  whole.triangleCount = static_cast<int>(mesh.triangles.size());
  whole.parts.resize(1);
  whole.parts[0].triangles = mesh.triangles;
  for (int i = 0; i < whole.triangleCount; ++i) whole.parts[0].sourceTriangle.push_back(i);
  for (int v = 0; v < whole.vertexCount; ++v) whole.parts[0].points.push_back(v);
  return whole;
}

TEST(PartBones, OfAWholeBarAreHalfAndHalf) {
  const Character character = bar();
  const auto bones = bonesOfParts(wholeOf(character.mesh), character);
  ASSERT_EQ(bones.size(), 1u);
  const auto shares = byName(bones[0]);
  ASSERT_EQ(shares.size(), 2u) << "the root moves nothing";
  // The diagonals of the box need not be symmetric, so the two triangles of a long face may favour one side by up to
  // 1/6.
  EXPECT_NEAR(shares.at("left"), 0.5, 1.0 / 6.0);
  EXPECT_NEAR(shares.at("left") + shares.at("right"), 1.0, 1e-12);
}

TEST(PartBones, CutPointsCountAsTheirEndsDoAndCapsDoNot) {
  // One triangle from (0, 0, 0) and (4, 0, 0) of "left" to (0, 3, 0) of "right", cut halfway up its sides: the lower
  // part has corners of weight 1, 1, 1/2, 1/2, the upper one 1/2, 1/2 and 0.
  Character character = bar();
  character.mesh = {{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}};
  character.influences = {{1, 1.0}, {1, 1.0}, {2, 1.0}};
  character.influenceBegin = {0, 1, 2, 3};
  Decomposition d;
  d.vertexCount = 3;
  d.triangleCount = 1;
  d.cutPoints = {{0, 2, 0.5}, {1, 2, 0.5}};
  d.splitFrom = {0, 0};
  d.parts.resize(3);
  d.parts[0] = {{{0, 1, 4}, {0, 4, 3}}, {0, 0}, {0, 1, 3, 4}};
  d.parts[1] = {{{3, 4, 2}, {2, 4, 3}}, {0, -1}, {2, 3, 4}};
  d.parts[2] = {{{3, 4, 2}}, {-1}, {2, 3, 4}};
  const auto bones = bonesOfParts(d, character);
  ASSERT_EQ(bones.size(), 3u);
  // Areas 3 and 1.5, mean weight of "left" at their corners 5/6 and 2/3.
  EXPECT_NEAR(byName(bones[0]).at("left"), (3.0 * 5.0 / 6.0 + 1.5 * 2.0 / 3.0) / 4.5, 1e-12);
  EXPECT_EQ(bones[0][0].bone, "left");
  EXPECT_NEAR(byName(bones[1]).at("left"), 1.0 / 3.0, 1e-12);
  EXPECT_EQ(bones[1][0].bone, "right");
  EXPECT_TRUE(bones[2].empty());
}

TEST(PartBones, OfTheWholeMannequinAreAsSymmetricAsItIs) {
  const Character character = makeMannequin();
  const auto bones = bonesOfParts(wholeOf(character.mesh), character);
  ASSERT_EQ(bones.size(), 1u);
  double sum = 0.0;
  for (const BoneShare& bone : bones[0]) sum += bone.share;
  EXPECT_NEAR(sum, 1.0, 1e-9);
  EXPECT_TRUE(std::is_sorted(bones[0].begin(), bones[0].end(),
                             [](const BoneShare& a, const BoneShare& b) { return a.share > b.share; }));
  const auto shares = byName(bones[0]);
  for (const char* limb : {"UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot"}) {
    const double left = shares.at(std::string("left") + limb);
    EXPECT_GT(left, 0.001) << limb;
    EXPECT_NEAR(left, shares.at(std::string("right") + limb), 0.01 * left) << limb;
  }
}

}  // namespace
}  // namespace lorica
