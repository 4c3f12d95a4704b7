#include "acd/hull_distance.h"

#include "acd/cap.h"
#include "geometry/mesh_files.h"
#include "geometry/triangle_tree.h"
#include "tests/acd/parts.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lorica {
namespace {

double distanceOf(const TriMesh& mesh, double ignoreBelow = 0.0) {
  return hullDistance(convexHull(mesh.vertices), mesh.vertices, mesh.triangles, ignoreBelow);
}

/// Checks the guarantee of hullDistance() for a known distance.
void expectWithin(double found, double truth) {
  EXPECT_GE(found, truth * (1.0 - 1e-12));
  EXPECT_LE(found, truth * 1.01 + 1e-12);
}

/// A prism over a polygon of the xy plane, counter-clockwise, from z = 0 to `depth`.
TriMesh prism(const std::vector<Vec2>& profile, double depth) {
  TriMesh mesh;
  for (const double z : {0.0, depth}) {
    for (const Vec2& p : profile) mesh.vertices.emplace_back(p.x(), p.y(), z);
  }
  const int n = countOf(profile);
  std::vector<CapEdge> border;
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    border.push_back({i, j});
    mesh.triangles.push_back({i, j, j + n});
    mesh.triangles.push_back({i, j + n, i + n});
  }
  for (const Triangle& t : triangulateCap(profile, border)) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  return mesh;
}

TEST(HullDistance, ConvexShapesAreNowhereOff) {
  EXPECT_LE(distanceOf(test::makeBox({0, 0, 0}, {1, 2, 3})), 1e-3 * std::sqrt(14.0));
  EXPECT_LE(distanceOf(test::makeTetrahedron()), 1e-3 * std::sqrt(3.0));
  EXPECT_LE(distanceOf(test::makeSphere(1.0, 30, 60)), 1e-3 * std::sqrt(12.0));
}

TEST(HullDistance, NotchesShallowAndDeepInClosedForm) {
  // A box of length 4 with a notch of width 2 in the middle of its top: from the hull's top face the distance to the
  // notch's floor is its depth, and the distance to the walls is at most 1.
  for (const double depth : {0.05, 0.3, 0.9, 1.5}) {
    SCOPED_TRACE(depth);
    const TriMesh notched =
        prism({{0, 0}, {4, 0}, {4, 2}, {3, 2}, {3, 2 - depth}, {1, 2 - depth}, {1, 2}, {0, 2}}, 1.0);
    ASSERT_TRUE(checkClosedTwoManifold(notched).ok()) << checkClosedTwoManifold(notched).error().message;
    ASSERT_NEAR(signedVolume(notched.vertices, notched.triangles), 8.0 - 2.0 * depth, 1e-12);
    expectWithin(distanceOf(notched), std::min(depth, 1.0));
  }
}

TEST(HullDistance, TorusWithAxisCrossingItsHole) {
  // The hull closes the hole at the height of the tube's top. On the axis at that height, the tube's centre line is R
  // away horizontally and r below: distance sqrt(R^2 + r^2) - r. At this resolution facets are within 1e-3 of the
  // circles.
  const double major = 2.0, minor = 0.5;
  const double truth = std::sqrt(major * major + minor * minor) - minor;
  const double found = distanceOf(test::makeTorus(major, minor, 128, 64));
  EXPECT_GE(found, truth - 2e-3);
  EXPECT_LE(found, 1.01 * truth + 2e-3);
}

TEST(HullDistance, LShapeAndTwoBoxesInClosedForm) {
  // The middle line of the hull's slanted face x + y = 3 is farthest away. From (1.5, 1.5, z) the nearest points are on
  // the two faces that meet at the concave edge, half a unit away.
  expectWithin(distanceOf(test::makeLShape()), 0.5);
  // Unit cubes with a gap of 3 between them: halfway the hull is 1.5 from both.
  expectWithin(distanceOf(test::joined(test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({4, 0, 0}, {5, 1, 1}))), 1.5);
}

TEST(HullDistance, WhatMayBeIgnoredIsBoundedOnly) {
  const TriMesh l = test::makeLShape();
  for (const double ignoreBelow : {0.6, 1.0, 5.0}) {
    const double found = distanceOf(l, ignoreBelow);
    EXPECT_GE(found, 0.5);
    EXPECT_LE(found, ignoreBelow);
  }
  expectWithin(distanceOf(l, 0.4), 0.5);
}

TEST(HullDistance, FlatPartsHaveNone) {
  EXPECT_EQ(distanceOf(test::moved(test::makeLShape(), [](const Vec3& p) { return Vec3(p.x(), p.y(), 0.0); })), 0.0);
}

TEST(HullDistance, RigidMotionAndScaleDoNotMatter) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (const double scale : {1e-6, 1.0, 1e6}) {
    SCOPED_TRACE(scale);
    const Quat rotation = Quat{normal(random), normal(random), normal(random), normal(random)}.normalized();
    const Vec3 shift{normal(random), normal(random), normal(random)};
    const auto map = [&](const Vec3& p) -> Vec3 { return scale * (rotation * p + shift); };
    EXPECT_NEAR(distanceOf(test::moved(test::makeLShape(), map)) / scale, 0.505, 0.0051);
  }
}

TEST(HullDistance, AgreesWithDenseSamplesOnPartsOfABunny) {
  LORICA_REQUIRE_DATASET(file, "vhacd/Bunny.off");
  const TriMesh mesh = test::valueOf(readMesh(file));
  const Decomposition made = test::decomposed(
      mesh, {.maxParts = 4, .preset = DecomposePreset::kPaper, .candidateEdges = 2, .planesPerEdge = 1});
  const std::vector<Vec3> points = test::transferred(made, mesh.vertices);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  for (const Part& part : made.parts) {
    const ConvexHull hull = partHull(part, points);
    const double found = hullDistance(hull, points, part.triangles, 0.0);

    std::vector<std::array<Vec3, 3>> surface;
    for (const Triangle& t : part.triangles) surface.push_back({points[t[0]], points[t[1]], points[t[2]]});
    const TriangleTree nearest(surface);
    double sampled = 0.0;
    for (const Triangle& t : hull.triangles) {
      const Vec3& a = hull.vertices[t[0]];
      const Vec3 ab = hull.vertices[t[1]] - a, ac = hull.vertices[t[2]] - a;
      const int samples =
          1 + static_cast<int>(40000.0 * ab.cross(ac).norm() / (2.0 * surfaceArea(hull.vertices, hull.triangles)));
      for (int i = 0; i < samples; ++i) {
        double u = uniform(random), v = uniform(random);
        if (u + v > 1.0) std::tie(u, v) = std::pair(1.0 - u, 1.0 - v);
        sampled = std::max(sampled, nearest.distance(a + u * ab + v * ac));
      }
    }
    EXPECT_GE(found, sampled);
    EXPECT_LE(found, 1.01 * sampled + 0.01 * boundsOf(hull.vertices).diagonal());
  }
}

}  // namespace
}  // namespace lorica
