#include "acd/separating_plane.h"

#include "geometry/convex_hull.h"
#include "geometry/random_numbers.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(SeparatingPlane, LiesBetweenBoxesHoweverCloseTheyAre) {
  const TriMesh below = test::makeBox({0, 0, 0}, {1, 1, 1});
  for (const double gap : {1.0, 0.1, 1e-2, 1e-4, 1e-6}) {
    for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(0, 0.3, -0.2), Vec3(0, 0.9, 0.9)}) {
      const TriMesh above = test::makeBox(Vec3(1 + gap, 0, 0) + shift, Vec3(2 + gap, 1, 1) + shift);
      const auto plane = separatingPlane(above.vertices, below.vertices);
      ASSERT_TRUE(plane) << gap;
      for (const Vec3& v : above.vertices) EXPECT_GE(plane->normal.dot(v) - plane->offset, 0.2 * gap) << gap;
      for (const Vec3& v : below.vertices) EXPECT_LE(plane->normal.dot(v) - plane->offset, -0.2 * gap) << gap;
    }
  }
}

TEST(SeparatingPlane, IsNoneForHullsThatTouchOrOverlap) {
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 1, 1});
  for (const auto& [low, high] : {std::pair{Vec3(0, 0, 0), Vec3(1, 1, 1)},
                                  {Vec3(1, 0, 0), Vec3(2, 1, 1)},
                                  {Vec3(1, 1, 1), Vec3(2, 2, 2)},
                                  {Vec3(0.2, 0.2, 0.2), Vec3(0.4, 0.4, 0.4)}}) {
    EXPECT_FALSE(separatingPlane(test::makeBox(low, high).vertices, box.vertices)) << low.transpose();
  }
}

TEST(SeparatingPlane, AgreesWithTheSideOfRandomHulls) {
  // Hulls of random points on two sides of a random plane are apart; with a point of the other side they are not.
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    RandomNumbers random(seed);
    const auto point = [&] {
      Vec3 p;
      for (double& x : p) x = random.between(-1.0, 1.0);
      return p;
    };
    const Vec3 normal = point().normalized();
    std::vector<Vec3> above, below;
    while (above.size() < 12 || below.size() < 12) {
      const Vec3 p = point();
      if (std::abs(normal.dot(p)) > 1e-3) (normal.dot(p) > 0.0 ? above : below).push_back(p);
    }
    EXPECT_TRUE(separatingPlane(above, below)) << "seed " << seed;
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : below) mean += p / static_cast<double>(below.size());
    above.push_back(mean);
    EXPECT_FALSE(separatingPlane(above, below)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace lorica
