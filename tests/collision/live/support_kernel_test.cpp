#include "collision/live/extent_kernel.h"

#include "collision/live/hull_distance.h"
#include "geometry/convex_hull.h"
#include "geometry/random_numbers.h"
#include "tests/collision/parts.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lorica::test {
namespace {

/// The first of the farthest points, one by one.
int slowSupport(const std::vector<float>& xyz, int count, const Vec3f& direction) {
  int best = 0;
  float max = -std::numeric_limits<float>::infinity();
  for (int i = 0; i < count; ++i) {
    const auto at = [&](int axis) { return xyz[axis * count + i]; };
    const float value = direction.x() * at(0) + direction.y() * at(1) + direction.z() * at(2);
    if (value > max) {
      max = value;
      best = i;
    }
  }
  return best;
}

void expectSupportAsSlow() {
  std::mt19937_64 random(81);
  for (const int count : {16, 32, 48, 64, 304, 1024}) {
    for (int i = 0; i < 200; ++i) {
      // Coarse coordinates and directions: many points are equally far.
      std::vector<float> xyz(3 * static_cast<std::size_t>(count));
      const bool coarse = i % 2 == 0;
      for (float& c : xyz) {
        const double value = test::uniform(random, -4.0, 4.0);
        c = static_cast<float>(coarse ? std::round(value) : value);
      }
      Vec3f direction = test::uniformVec3(random, -1.0, 1.0).cast<float>();
      if (coarse) direction = direction.array().round();
      const float* x = xyz.data();
      EXPECT_EQ(supportIndex(x, x + count, x + 2 * count, count, direction.x(), direction.y(), direction.z()),
                slowSupport(xyz, count, direction))
          << count << " points, case " << i;
    }
  }
}

TEST(SupportKernel, FindsTheFirstFarthestPointWithEveryInstructionSet) {
  test::onEveryInstructionSet(expectSupportAsSlow);
}

TEST(SupportKernel, ADirectionThatIsNoNumberGivesAPoint) {
  const std::vector<float> xyz(48, 1.0f);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(supportIndex(xyz.data(), xyz.data() + 16, xyz.data() + 32, 16, nan, nan, nan), 0);
}

void expectExtentsAsSlow() {
  std::mt19937_64 random(82);
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = test::uniformVec3(random, -2.0, 2.0);
    Isometry3 motion = Isometry3::Identity();
    motion.linear() = Quat(Eigen::AngleAxisd(test::uniform(random, -3.0, 3.0), Vec3(1.0, 2.0, -2.0) / 3.0)).matrix();
    motion.translation() = test::uniformVec3(random, -5.0, 5.0);
    Aabb slow;
    double slowSq = 0.0;
    for (const Vec3& p : points) {
      slow.extend(motion * p);
      slowSq = std::max(slowSq, p.squaredNorm());
    }
    const Aabb bounds = boundsOf(points, motion);
    EXPECT_EQ(farthestSq(points), slowSq) << count << " points";
    EXPECT_EQ(bounds.empty(), count == 0);
    if (count == 0) continue;
    EXPECT_LT((bounds.min - slow.min).norm(), 1e-14) << count << " points";
    EXPECT_LT((bounds.max - slow.max).norm(), 1e-14) << count << " points";
  }
}

TEST(ExtentKernel, HoldsAllPointsWithEveryInstructionSet) {
  test::onEveryInstructionSet(expectExtentsAsSlow);
}

std::vector<Vec3> cloud(RandomNumbers& random, int count, const Vec3& middle, double size) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(middle + size * Vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)));
  }
  return convexHull(points).vertices;
}

double highest(const std::vector<Vec3>& points, const Vec3& along) {
  double most = -kInfinity;
  for (const Vec3& p : points) most = std::max(most, p.dot(along));
  return most;
}

/// A distance is proven by a point of each hull that far from each other, and a slab that wide between the hulls.
TEST(HullDistance, TwoHullsAreProvenToBeThatFarApart) {
  RandomNumbers random(5);
  int apart = 0, meeting = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const std::vector<Vec3> first = cloud(random, 4 + trial % 60, Vec3::Zero(), 0.1);
    const Vec3 middle(random.between(-0.3, 0.3), random.between(-0.3, 0.3), random.between(-0.3, 0.3));
    const std::vector<Vec3> second = cloud(random, 4 + trial % 37, middle, 0.1);
    const HullGap gap = gapOf(first, second);
    if (gap.distance == 0.0) {
      ++meeting;
      // A plane between the hulls would be found from the other side, too.
      EXPECT_EQ(gapOf(second, first).distance, 0.0) << trial;
      continue;
    }
    ++apart;
    const double slab = -highest(second, -gap.normal) - highest(first, gap.normal);
    EXPECT_NEAR(slab, gap.distance, 1e-9) << trial;
    EXPECT_NEAR(gap.normal.norm(), 1.0, 1e-12);
    EXPECT_LT(largestViolation(convexHull(first), std::vector{gap.onHull}), 1e-9) << trial;
    EXPECT_LT(largestViolation(convexHull(second), std::vector<Vec3>{gap.onHull + gap.distance * gap.normal}), 1e-9)
        << trial;
  }
  EXPECT_GT(apart, 1000);
  EXPECT_GT(meeting, 200);
}

std::vector<Vec3> box(const Vec3& low, const Vec3& sides) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(low + sides.cwiseProduct(Vec3(i & 1, i >> 1 & 1, i >> 2)));
  return corners;
}

/// All faces are parallel, and most simplices are flat.
TEST(HullDistance, AlignedBoxesAreAsFarApartAsTheirSidesSay) {
  RandomNumbers random(6);
  const auto grid = [&](double least, double most) { return 0.1 * std::floor(random.between(10 * least, 10 * most)); };
  int meeting = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Vec3 sides(grid(0.1, 1), grid(0.1, 1), grid(0.1, 1)), others(grid(0.1, 1), grid(0.1, 1), grid(0.1, 1));
    const Vec3 low(grid(-1.5, 1.5), grid(-1.5, 1.5), grid(-1.5, 1.5));
    Vec3 apart;
    for (int axis = 0; axis < 3; ++axis) {
      apart[axis] = std::max({0.0, low[axis] - sides[axis], -low[axis] - others[axis]});
    }
    meeting += apart.isZero(1e-9) ? 1 : 0;
    EXPECT_NEAR(gapOf(box(Vec3::Zero(), sides), box(low, others)).distance, apart.norm(), 1e-9) << trial;
  }
  EXPECT_GT(meeting, 200);
}

TEST(HullDistance, PointsSegmentsAndFacesThatAreParallelHaveADistance) {
  const std::vector<Vec3> square = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  std::vector<Vec3> above;
  for (const Vec3& p : square) above.emplace_back(p + Vec3(0.25, 0.5, 0.25));
  EXPECT_NEAR(gapOf(square, above).distance, 0.5, 1e-12);
  EXPECT_NEAR(gapOf(square, std::vector<Vec3>{{0.5, 0.3, 0.5}}).distance, 0.3, 1e-12);
  EXPECT_NEAR(gapOf(std::vector<Vec3>{{0, 0, 0}}, std::vector<Vec3>{{3, 4, 0}}).distance, 5.0, 1e-12);
  EXPECT_EQ(gapOf(square, square).distance, 0.0);
  // As a segment, and as a hull of two points.
  const Vec3 middle(2.0, 0.4, 0.3), half(0.1, 0.2, -0.4);
  EXPECT_NEAR(gapOf(square, middle, half).distance,
              gapOf(square, std::vector<Vec3>{middle - half, middle + half}).distance, 1e-12);
}

}  // namespace
}  // namespace lorica::test
