#include "acd/small_lp.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace lorica {
namespace {

constexpr double kReach = 50.0;

/// Slow reference: the minimum objective over all intersections of three planes.
double byCorners(const Vec3& objective, std::vector<HalfSpace> halfSpaces) {
  for (int axis = 0; axis < 3; ++axis) {
    halfSpaces.push_back({Vec3::Unit(axis), -kReach});
    halfSpaces.push_back({-Vec3::Unit(axis), -kReach});
  }
  double best = std::numeric_limits<double>::infinity();
  const std::size_t n = halfSpaces.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        Mat3 rows;
        rows << halfSpaces[i].normal.transpose(), halfSpaces[j].normal.transpose(), halfSpaces[k].normal.transpose();
        if (std::abs(rows.determinant()) < 1e-9) continue;
        const Vec3 corner = rows.inverse() * Vec3(halfSpaces[i].offset, halfSpaces[j].offset, halfSpaces[k].offset);
        bool inside = true;
        for (const HalfSpace& h : halfSpaces) inside &= h.normal.dot(corner) >= h.offset - 1e-8;
        if (inside) best = std::min(best, objective.dot(corner));
      }
    }
  }
  return best;
}

TEST(SmallLp, AgreesWithAllCornersOneByOne) {
  std::mt19937 random(21);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  int feasible = 0, infeasible = 0;
  for (int run = 0; run < 300; ++run) {
    SCOPED_TRACE(run);
    std::vector<HalfSpace> halfSpaces;
    const int count = run % 14;
    // Mostly around a common point, sometimes not.
    const Vec3 common = vector();
    const double room = run % 3 == 0 ? -0.5 : 0.5;
    for (int i = 0; i < count; ++i) {
      const Vec3 n = vector().normalized();
      halfSpaces.push_back({n, n.dot(common) - room * std::abs(normal(random))});
    }
    const Vec3 objective = vector();
    const std::optional<Vec3> found = minimizeLinear(objective, halfSpaces, kReach);
    const double truth = byCorners(objective, halfSpaces);
    if (!found) {
      EXPECT_EQ(truth, std::numeric_limits<double>::infinity());
      ++infeasible;
      continue;
    }
    ++feasible;
    EXPECT_NEAR(objective.dot(*found), truth, 1e-6);
    for (const HalfSpace& h : halfSpaces) EXPECT_GE(h.normal.dot(*found), h.offset - 1e-9);
    EXPECT_LE(found->cwiseAbs().maxCoeff(), kReach * (1.0 + 1e-12));
  }
  EXPECT_GT(feasible, 100);
  EXPECT_GT(infeasible, 20);
}

TEST(SmallLp, OppositeHalfSpacesShareNothing) {
  const std::vector<HalfSpace> apart = {{Vec3::UnitX(), 1.0}, {-Vec3::UnitX(), 1.0}};
  EXPECT_FALSE(minimizeLinear(Vec3::UnitY(), apart, kReach));
  const std::vector<HalfSpace> touching = {{Vec3::UnitX(), 1.0}, {-Vec3::UnitX(), -1.0}};
  const std::optional<Vec3> found = minimizeLinear(Vec3(1, 1, 1), touching, kReach);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->x(), 1.0, 1e-12);
  EXPECT_NEAR(found->y(), -kReach, 1e-9);
}

}  // namespace
}  // namespace lorica
