#include "acd/half_volumes.h"

#include "acd/transfer.h"
#include "geometry/convex_hull.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

namespace lorica {
namespace {

FloatPoints floats(std::span<const Vec3> points) {
  FloatPoints result;
  for (const Vec3& p : points) {
    result.x.push_back(static_cast<float>(p.x()));
    result.y.push_back(static_cast<float>(p.y()));
    result.z.push_back(static_cast<float>(p.z()));
  }
  return result;
}

Support supportOf(const FloatPoints& points) {
  std::vector<std::int32_t> ids(points.size());
  std::iota(ids.begin(), ids.end(), 0);
  Support support;
  support.clear();
  include(support, points, ids, 0, nullptr);
  return support;
}

std::vector<Vec3> randomPoints(int count) {
  std::mt19937_64 random(5);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; };
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back(Vec3{uniform(), uniform(), uniform()});
  return points;
}

TEST(Support, OfAUnionIsTheUnionOfSupports) {
  const FloatPoints all = floats(randomPoints(300));
  const Support whole = supportOf(all);
  std::vector<std::int32_t> first(200), second(100);
  std::iota(first.begin(), first.end(), 0);
  std::iota(second.begin(), second.end(), 200);
  Support a, b;
  a.clear();
  b.clear();
  include(a, all, first, 0, nullptr);
  include(b, all, second, 0, nullptr);
  Support bounded = a;
  include(bounded, all, second, 0, &b);  // directions in which b is not beyond a may be skipped
  include(a, b);
  EXPECT_EQ(a.high, whole.high);
  EXPECT_EQ(a.low, whole.low);
  EXPECT_EQ(a.highest, whole.highest);
  EXPECT_EQ(a.lowest, whole.lowest);
  EXPECT_EQ(bounded.highest, whole.highest);
  EXPECT_EQ(bounded.lowest, whole.lowest);
}

TEST(Support, EnclosesABoxExactlyAndMostOfASphere) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back((i & 1) * 2.0, (i & 2) * 1.5, (i & 4) * 1.0);
  const FloatPoints box = floats(corners);
  EXPECT_NEAR(enclosedVolume(supportOf(box), box, {}), 2.0 * 3.0 * 4.0, 1e-4);

  std::vector<Vec3> dense = randomPoints(100000);
  for (Vec3& p : dense) p.normalize();
  const FloatPoints sphere = floats(dense);
  const double volume = enclosedVolume(supportOf(sphere), sphere, {}) / (4.0 / 3.0 * std::numbers::pi);
  EXPECT_LT(volume, 1.0);
  EXPECT_GT(volume, 0.92);
}

TEST(Support, EnclosesAtMostTheHull) {
  const std::vector<Vec3> points = randomPoints(40);
  const FloatPoints cloud = floats(points);
  const double hull = convexHullVolume(points);
  const double enclosed = enclosedVolume(supportOf(cloud), cloud, {});
  EXPECT_LE(enclosed, hull * (1.0 + 1e-5));
  EXPECT_GT(enclosed, 0.9 * hull);
}

/// A torus in two keyframes, with planes through vertices, along faces, and at arbitrary positions.
struct Halves : ::testing::Test {
  Halves() : mesh(test::makeTorus(1.0, 0.4, 120, 60)), keyframes(2, mesh.vertices) {
    whole.triangles = mesh.triangles;
    whole.sourceTriangle.assign(mesh.triangles.size(), 0);
    whole.points = pointsUsedBy(whole.triangles);
    for (Vec3& v : keyframes[1]) v.y() += 0.3 * std::sin(2.0 * v.x());
  }
  /// Hull volumes of the halves that the cut actually produces.
  std::pair<double, double> truth(const Plane& plane, std::size_t k) const {
    const CutResult cut = cutPart(whole, mesh.vertices, plane, 1e-9, static_cast<PointIndex>(mesh.vertices.size()));
    std::vector<Vec3> all = keyframes[k];
    for (const CutPoint& c : cut.newPoints) {
      all.push_back(c.lambda * all[c.first] + (1.0 - c.lambda) * all[c.second]);
    }
    return {partHull(cut.above, all).volume, partHull(cut.below, all).volume};
  }

  TriMesh mesh;
  std::vector<std::vector<Vec3>> keyframes;
  Part whole;
  const std::vector<Plane> planes = {{Vec3::UnitX(), 0.0}, {Vec3::UnitY(), 0.0}, {Vec3(1, 2, 3).normalized(), 0.1}};
};

TEST_F(Halves, VolumesEqualThoseOfTheCut) {
  const PartTree tree(whole, keyframes, 0);
  for (const bool reduce : {false, true}) {
    const HalfVolumes volumes(tree, reduce);
    for (const Plane& plane : planes) {
      PartTree::Sketch sketch;
      ASSERT_TRUE(tree.sketch(plane, 1e-9, sketch));
      for (std::size_t k = 0; k < keyframes.size(); ++k) {
        const auto [above, below] = truth(plane, k);
        EXPECT_NEAR(volumes.above(sketch, k, 1e-10), above, 1e-9);
        EXPECT_NEAR(volumes.below(sketch, k, 1e-10), below, 1e-9);
      }
    }
  }
}

TEST_F(Halves, EstimatesAreALittleSmall) {
  const PartTree tree(whole, keyframes, 0);
  const HalfEstimates estimates(tree);
  for (const Plane& plane : planes) {
    PartTree::Sketch sketch;
    ASSERT_TRUE(tree.sketch(plane, 1e-9, sketch));
    const auto [above, below] = estimates.volumes(sketch);
    const auto first = truth(plane, 0);
    const auto second = truth(plane, 1);
    EXPECT_LE(above, (first.first + second.first) * (1.0 + 1e-5));
    EXPECT_LE(below, (first.second + second.second) * (1.0 + 1e-5));
    EXPECT_GT(above, (first.first + second.first) * 0.88);
    EXPECT_GT(below, (first.second + second.second) * 0.88);
  }
}

TEST_F(Halves, APlaneBesideThePartDoesNotDivideIt) {
  const PartTree tree(whole, keyframes, 0);
  PartTree::Sketch sketch;
  EXPECT_FALSE(tree.sketch({Vec3::UnitX(), 5.0}, 1e-9, sketch));
}

}  // namespace
}  // namespace lorica
