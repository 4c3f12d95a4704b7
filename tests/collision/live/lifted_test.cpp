#include "collision/live/lifted_kernel.h"
#include "collision/live/lifted_part.h"
#include "collision/live/lifted_point.h"
#include "collision/live/rigid_fit.h"
#include "tests/collision/dancer.h"
#include "tests/collision/parts.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

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

TEST(LiftedPart, SeesAndSumsItsBonesTheSameOnEveryInstructionSet) {
  std::mt19937_64 random(25);
  const std::vector<LiftedPoint> points = randomPoints(random, 100);
  const std::vector<Affine3> bones = randomBones(random);
  const LiftedPart part(points);
  const LiftedPart::Moments moments = part.momentsOf(bones);
  const Isometry3 worldFromPart = positionOf(part, bones);
  LiftedPart::TakenPose taken = part.noPose();
  ASSERT_TRUE(part.take(bones, worldFromPart, 0x1p-21, taken));
  test::onEveryInstructionSet([&] {
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

}  // namespace
}  // namespace lorica
