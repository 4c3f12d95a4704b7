#include "geometry/triangle_tree.h"

#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace lorica {
namespace {

Vec3 somewhere(RandomNumbers& random, double reach) {
  const double x = random.between(-reach, reach);
  const double y = random.between(-reach, reach);
  return {x, y, random.between(-reach, reach)};
}

/// Random triangles, some of them slivers, segments and points.
TriMesh soup(int count, RandomNumbers& random) {
  TriMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = somewhere(random, 1.0);
    const Vec3 b = a + somewhere(random, 0.2);
    Vec3 c = a + somewhere(random, 0.2);
    if (i % 10 == 7) c = 0.5 * (a + b);
    if (i % 10 == 8) c = b;
    const auto v = countOf(mesh.vertices);
    mesh.vertices.insert(mesh.vertices.end(), {a, b, i % 10 == 9 ? a : c});
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  return mesh;
}

std::array<Vec3, 3> cornersOf(const TriMesh& mesh, std::size_t k) {
  const Triangle& t = mesh.triangles[k];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

/// The nearest point of a triangle by sampling many points.
double distanceBySampling(const Vec3& p, const std::array<Vec3, 3>& t) {
  constexpr int kSteps = 120;
  double min = 1e9;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const double u = static_cast<double>(i) / kSteps, v = static_cast<double>(j) / kSteps;
      min = std::min(min, (t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]) - p).norm());
    }
  }
  return min;
}

TEST(TriangleTree, TheNearestPointOfATriangleIsIt) {
  RandomNumbers random(3);
  const TriMesh mesh = soup(40, random);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const std::array<Vec3, 3> t = cornersOf(mesh, k);
    const Vec3 p = somewhere(random, 1.0);
    const auto [distanceSq, shares] = nearestOnTriangle(p, t);
    EXPECT_NEAR(shares.sum(), 1.0, 1e-12);
    EXPECT_GE(shares.minCoeff(), 0.0);
    EXPECT_NEAR((shares[0] * t[0] + shares[1] * t[1] + shares[2] * t[2] - p).norm(), std::sqrt(distanceSq), 1e-9);
    const double sampled = distanceBySampling(p, t);
    EXPECT_LE(std::sqrt(distanceSq), sampled + 1e-12);
    EXPECT_NEAR(std::sqrt(distanceSq), sampled, 4e-3);
  }
}

TEST(TriangleTree, FindsWhatASearchOfAllFinds) {
  RandomNumbers random(4);
  for (const int count : {1, 4, 5, 300}) {
    const TriMesh mesh = soup(count, random);
    const TriangleTree tree(mesh.vertices, mesh.triangles);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = somewhere(random, 1.5);
      double min = 1e9, minEven = 1e9;
      std::set<std::int32_t> within;
      for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
        const double distance = std::sqrt(nearestOnTriangle(p, cornersOf(mesh, k)).first);
        min = std::min(min, distance);
        if (k % 2 == 0) minEven = std::min(minEven, distance);
        if (distance <= 0.3) within.insert(static_cast<std::int32_t>(k));
      }
      EXPECT_DOUBLE_EQ(tree.nearest(p).distance, min);
      const auto even =
          tree.nearest(p, std::numeric_limits<double>::infinity(), [](std::int32_t t) { return t % 2 == 0; });
      EXPECT_DOUBLE_EQ(even.distance, minEven);
      EXPECT_EQ(even.triangle % 2, 0);
      EXPECT_EQ(tree.nearest(p, 0.9 * min, [](std::int32_t) { return true; }).triangle, -1);
      std::set<std::int32_t> visited;
      tree.forEachWithin(p, 0.3, [&](std::int32_t t, double distance) {
        visited.insert(t);
        EXPECT_DOUBLE_EQ(distance, std::sqrt(nearestOnTriangle(p, cornersOf(mesh, static_cast<std::size_t>(t))).first));
      });
      EXPECT_EQ(visited, within);
    }
  }
}

TEST(TriangleTree, WindingNumbersAreThoseOfClosedForms) {
  RandomNumbers random(5);
  const TriMesh sphere = test::makeSphere(1.0, 40, 60);
  const TriangleTree whole(sphere.vertices, sphere.triangles);
  TriMesh half = sphere;
  std::erase_if(half.triangles, [&](const Triangle& t) {
    return (sphere.vertices[t[0]] + sphere.vertices[t[1]] + sphere.vertices[t[2]]).y() < 0.0;
  });
  const TriangleTree dome(half.vertices, half.triangles);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = somewhere(random, 2.0);
    if (std::abs(p.norm() - 1.0) > 0.02) {
      EXPECT_NEAR(whole.windingNumber(p), p.norm() < 1.0 ? 1.0 : 0.0, 0.05);
    }
    // From the dome's axis its missing disc is seen as a cone.
    const double y = random.between(-1.9, 0.9);
    const double cone = 0.5 * (1.0 - std::abs(y) / std::sqrt(1.0 + y * y));
    EXPECT_NEAR(dome.windingNumber(Vec3(0, y, 0)), y > 0.0 ? 1.0 - cone : cone, 0.05) << y;
  }
  EXPECT_NEAR(whole.windingNumber(Vec3(100, 0, 0)), 0.0, 1e-6);
}

}  // namespace
}  // namespace lorica
