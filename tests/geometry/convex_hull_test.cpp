#include "geometry/convex_hull.h"

#include "geometry/counts.h"
#include "geometry/mass_properties.h"
#include "geometry/random_numbers.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace lorica {
namespace {

std::vector<Vec3> randomPoints(int count, unsigned seed, bool onSphere) {
  std::mt19937_64 random(seed);
  std::vector<Vec3> points;
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 * 2.0 - 1.0; };
  while (countOf(points) < count) {
    const Vec3 p{uniform(), uniform(), uniform()};
    if (p.norm() > 1.0 || p.norm() < 0.1) continue;
    points.push_back(onSphere ? p.normalized() : p);
  }
  return points;
}

/// Checks: closed, oriented, Euler's formula, and no point outside.
void expectValid(const ConvexHull& hull, std::span<const Vec3> points) {
  ASSERT_FALSE(hull.degenerate());
  std::map<std::pair<int, int>, int> edges;
  for (const Triangle& t : hull.triangles) {
    for (int e = 0; e < 3; ++e) ++edges[{t[e], t[(e + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first})) << "open edge " << edge.first << "-" << edge.second;
  }
  EXPECT_EQ(std::ssize(hull.vertices) - std::ssize(edges) / 2 + std::ssize(hull.triangles), 2);
  EXPECT_NEAR(hull.volume, signedVolume(hull.vertices, hull.triangles), 1e-12 * std::abs(hull.volume));
  EXPECT_LE(largestViolation(hull, points), 1e-9 * boundsOf(points).diagonal());
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    EXPECT_EQ(hull.vertices[i], points[hull.pointOfVertex[i]]);
  }
}

/// Slow independent reference: a triangle of points is a facet if all other points are on one side.
double bruteForceVolume(std::span<const Vec3> points) {
  Vec3 inside = Vec3::Zero();
  for (const Vec3& p : points) inside += p / static_cast<double>(points.size());
  double volume = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const Vec3 n = (points[j] - points[i]).cross(points[k] - points[i]);
        int above = 0, below = 0;
        for (std::size_t l = 0; l < points.size(); ++l) {
          if (l == i || l == j || l == k) continue;
          (n.dot(points[l] - points[i]) > 0 ? above : below) += 1;
        }
        if (above == 0 || below == 0) volume += std::abs(n.dot(points[i] - inside)) / 6.0;
      }
    }
  }
  return volume;
}

TEST(ConvexHull, FewEqualCollinearAndCoplanarPointsAreDegenerate) {
  const std::vector<Vec3> three = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<Vec3> line, plane;
  for (int i = 0; i < 20; ++i) {
    line.emplace_back(0.1 * i, 0.2 * i, -0.3 * i);
    plane.emplace_back(std::cos(i), std::sin(i), 0.5 * std::cos(i) - 0.25 * std::sin(i));
  }
  for (const auto& [what, points] : {std::pair{"none", std::vector<Vec3>()},
                                     {"three", three},
                                     {"ten equal ones", std::vector<Vec3>(10, Vec3(1, 2, 3))},
                                     {"a line", line},
                                     {"a plane", plane}}) {
    EXPECT_TRUE(convexHull(points).degenerate()) << what;
  }
  EXPECT_EQ(convexHullVolume(three), 0.0);
  EXPECT_EQ(convexHull(plane).vertices.size(), plane.size());
}

TEST(ConvexHull, TetrahedronHasAllFourCornersAndVolumeOneSixth) {
  const std::vector<Vec3> corners = test::makeTetrahedron().vertices;
  const ConvexHull hull = convexHull(corners);
  expectValid(hull, corners);
  EXPECT_EQ(hull.vertices.size(), 4u);
  EXPECT_DOUBLE_EQ(hull.volume, 1.0 / 6.0);
}

TEST(ConvexHull, GridPointsOfACubeLeaveOnlyItsEightCorners) {
  std::vector<Vec3> points;
  for (int x = 0; x <= 6; ++x) {
    for (int y = 0; y <= 6; ++y) {
      for (int z = 0; z <= 6; ++z) points.emplace_back(x, y, z);
    }
  }
  const ConvexHull hull = convexHull(points);
  expectValid(hull, points);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.triangles.size(), 12u);
  EXPECT_DOUBLE_EQ(hull.volume, 216.0);
}

TEST(ConvexHull, CoplanarFacesInAnyOrientationContainTheirPoints) {
  // Rounding makes rotated planes not quite flat, which breaks hull algorithms with a single absolute tolerance.
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const Quat q = Quat(std::cos(trial), std::sin(trial * 1.3), std::cos(trial * 0.7), 0.3).normalized();
    std::vector<Vec3> points;
    for (int i = 0; i < 400; ++i) {
      Vec3 p;
      for (double& x : p) x = static_cast<double>(random() % 11);
      p[static_cast<int>(random() % 3)] = random() % 2 ? 0.0 : 10.0;
      points.push_back(q * p * 0.1 + Vec3(3, 2, 1));
    }
    expectValid(convexHull(points), points);
  }
}

TEST(ConvexHull, AgreesWithBruteForce) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::vector<Vec3> points = randomPoints(24, seed, seed % 2 == 0);
    EXPECT_NEAR(convexHullVolume(points), bruteForceVolume(points), 1e-12) << "seed " << seed;
  }
}

TEST(ConvexHull, EveryPointOnASphereIsAVertex) {
  const std::vector<Vec3> points = randomPoints(3000, 5, true);
  const ConvexHull hull = convexHull(points);
  expectValid(hull, points);
  EXPECT_EQ(hull.vertices.size(), points.size());
  EXPECT_NEAR(hull.volume, 4.0 / 3.0 * std::numbers::pi, 0.03);
}

TEST(ConvexHull, RandomSetsAtEveryScaleAreValid) {
  for (const double scale : {1e-9, 1e-3, 1.0, 1e6, 1e12}) {
    std::vector<Vec3> points = randomPoints(2000, 11, false);
    for (Vec3& p : points) p = p * scale + Vec3(5, -3, 2) * scale;
    expectValid(convexHull(points), points);
  }
}

TEST(ConvexHull, RigidMotionKeepsTheVolume) {
  const std::vector<Vec3> points = randomPoints(500, 3, false);
  std::vector<Vec3> moved;
  const Quat q = Quat(0.3, -0.5, 0.2, 0.7).normalized();
  for (const Vec3& p : points) moved.push_back(q * p + Vec3(1, 2, 3));
  EXPECT_NEAR(convexHullVolume(points), convexHullVolume(moved), 1e-12);
}

TEST(ConvexHull, ThinSlabsAndNeedlesAreValid) {
  for (const double thickness : {1e-3, 1e-5, 1e-7}) {
    std::vector<Vec3> points = randomPoints(800, 13, false);
    for (Vec3& p : points) p.y() *= thickness;
    expectValid(convexHull(points), points);
    for (Vec3& p : points) p.z() *= thickness;
    expectValid(convexHull(points), points);
  }
}

TEST(ConvexHull, DuplicatedPointsChangeNothing) {
  std::vector<Vec3> points = randomPoints(200, 17, false);
  const double volume = convexHullVolume(points);
  const std::vector<Vec3> copy = points;
  points.insert(points.end(), copy.begin(), copy.end());
  expectValid(convexHull(points), points);
  EXPECT_DOUBLE_EQ(convexHullVolume(points), volume);
}

TEST(ConvexHull, SameCallTwiceIsBitEqual) {
  const std::vector<Vec3> points = randomPoints(1000, 23, false);
  const ConvexHull a = convexHull(points);
  (void)convexHull(randomPoints(5000, 1, true));
  const ConvexHull b = convexHull(points);
  EXPECT_EQ(a.pointOfVertex, b.pointOfVertex);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.volume, b.volume);
}

/// The ends of a prism have so many faces on one plane that those that are level with a new point stay.
TEST(ConvexHull, PrismsOfVeryManySides) {
  struct Row {
    int sides;
    bool middles;                 // and the middle of each edge, which is no vertex
    std::vector<double> heights;  // those between the ends are on the upright edges
  };
  for (const Row& row : {Row{63, false, {0, 64}}, Row{200, false, {0, 64}}, Row{200, true, {0, 64}},
                         Row{1000, true, {0, 64}}, Row{200, false, {0, 32, 64}}, Row{400, true, {0, 16, 48, 64}}}) {
    // A convex polygon of even numbers: two parabolas, so that middles are exact.
    std::vector<Vec3> outline;
    const int half = row.sides / 2;
    for (int i = 0; i < half; ++i) outline.emplace_back(2.0 * i, 0.0, 2.0 * i * (half - i));
    for (int i = half; i > 0; --i) outline.emplace_back(2.0 * i, 0.0, -2.0 * i * (half - i) - 2.0);
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      std::vector<std::pair<std::uint64_t, Vec3>> shuffled;
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec3 middle = 0.5 * (outline[i] + outline[(i + 1) % outline.size()]);
        for (const double y : row.heights) {
          shuffled.emplace_back(randomBits(seed, shuffled.size()), Vec3(outline[i] + Vec3(0, y, 0)));
          if (row.middles) shuffled.emplace_back(randomBits(seed, shuffled.size()), Vec3(middle + Vec3(0, y, 0)));
        }
      }
      std::sort(shuffled.begin(), shuffled.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      std::vector<Vec3> points;
      for (const auto& [order, p] : shuffled) points.push_back(p);
      const ConvexHull hull = convexHull(points);
      EXPECT_EQ(hull.vertices.size(), 2 * outline.size());
      EXPECT_EQ(hull.triangles.size(), 2 * hull.vertices.size() - 4);
      EXPECT_TRUE(checkClosedTwoManifold({hull.vertices, hull.triangles}));
      EXPECT_LE(largestViolation(hull, points), 1e-9);
      EXPECT_NEAR(hull.volume, signedVolume(hull.vertices, hull.triangles), 1e-9 * hull.volume);
      double bottom = 0.0;  // what its faces on the plane y = 0 cover
      for (const Triangle& t : hull.triangles) {
        const Vec3 cross = (hull.vertices[t[1]] - hull.vertices[t[0]]).cross(hull.vertices[t[2]] - hull.vertices[t[0]]);
        if (std::ranges::all_of(t, [&](VertexIndex v) { return hull.vertices[v].y() == 0.0; })) {
          EXPECT_GT(cross.norm(), 0.0);
          bottom += 0.5 * cross.norm();
        }
      }
      EXPECT_NEAR(bottom * 64.0, hull.volume, 1e-9 * hull.volume);
    }
  }
}

/// Of a regular prism each new corner is level with an end and with the sides between the corners beside it.
TEST(ConvexHull, RegularPrismsOfVeryManySides) {
  for (const int sides : {64, 500, 4000}) {
    std::vector<Vec3> points;
    for (const double y : {0.0, 1.0}) {
      for (int i = 0; i < sides; ++i) points.emplace_back(cos(2.0 * M_PI * i / sides), y, sin(2.0 * M_PI * i / sides));
    }
    const ConvexHull hull = convexHull(points);
    EXPECT_EQ(hull.vertices.size(), points.size());
    EXPECT_EQ(hull.triangles.size(), 2 * hull.vertices.size() - 4);
    EXPECT_TRUE(checkClosedTwoManifold({hull.vertices, hull.triangles}));
    EXPECT_LE(largestViolation(hull, points), 1e-9);
    EXPECT_NEAR(hull.volume, 0.5 * sides * sin(2.0 * M_PI / sides), 1e-9);
    EXPECT_NEAR(signedVolume(hull.vertices, hull.triangles), hull.volume, 1e-9);
  }
}

/// Turned, the corners of an end are level but for rounding: added farthest first, each would see most of the end's
/// faces, of which 20,000 sides would make some hundred millions.
TEST(ConvexHull, TurnedPrismsOfVeryManySides) {
  constexpr int kSides = 20'000;
  const Mat3 turn = Quat(0.3, 0.5, -0.7, 0.2).normalized().toRotationMatrix();
  std::vector<Vec3> points;
  for (const double y : {0.0, 1.0}) {
    for (int i = 0; i < kSides; ++i) {
      points.emplace_back(turn * Vec3(cos(2.0 * M_PI * i / kSides), y, sin(2.0 * M_PI * i / kSides)));
    }
  }
  const ConvexHull hull = convexHull(points);
  EXPECT_GT(hull.vertices.size(), points.size() * 9 / 10);
  EXPECT_EQ(hull.triangles.size(), 2 * hull.vertices.size() - 4);
  EXPECT_TRUE(checkClosedTwoManifold({hull.vertices, hull.triangles}));
  EXPECT_NEAR(hull.volume, 0.5 * kSides * sin(2.0 * M_PI / kSides), 1e-8);
}

MassProperties of(const TriMesh& mesh) {
  return massProperties(mesh.vertices, mesh.triangles);
}

TriMesh moved(TriMesh mesh, const Isometry3& transform) {
  for (Vec3& v : mesh.vertices) v = transform * v;
  return mesh;
}

const Isometry3 kSomewhere =
    Eigen::Translation3d(3.0, -7.0, 0.5) * Eigen::AngleAxisd(0.8, Vec3(1.0, 2.0, -0.5).normalized());

TEST(MassProperties, NothingAndFlatThingsWeighNothing) {
  EXPECT_EQ(massProperties({}, {}).volume, 0.0);
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> bothSides = {{0, 1, 2}, {0, 2, 1}};
  const MassProperties flat = massProperties(corners, bothSides);
  EXPECT_EQ(flat.volume, 0.0);
  EXPECT_TRUE(flat.inertia.isZero());
}

TEST(MassProperties, ABoxHasTheInertiaOfTheBook) {
  const MassProperties box = of(test::makeBox(Vec3(1, 2, 3), Vec3(1.4, 2.6, 4)));
  const double a = 0.4, b = 0.6, c = 1.0, volume = a * b * c;
  EXPECT_NEAR(box.volume, volume, 1e-14);
  EXPECT_TRUE(box.center.isApprox(Vec3(1.2, 2.3, 3.5), 1e-14));
  const Vec3 moments = volume / 12.0 * Vec3(b * b + c * c, a * a + c * c, a * a + b * b);
  EXPECT_TRUE(box.inertia.isApprox(Mat3(moments.asDiagonal()), 1e-12)) << box.inertia;
}

TEST(MassProperties, ACornerTetrahedronHasTheIntegralsOfTheBook) {
  const MassProperties corner = of(test::makeTetrahedron());
  EXPECT_NEAR(corner.volume, 1.0 / 6.0, 1e-15);
  EXPECT_TRUE(corner.center.isApprox(Vec3::Constant(0.25), 1e-14));
  // The integral of x^2 over it is 1/60, that of x y 1/120; about the centre, each is 1/96 less.
  const double square = 1.0 / 60.0 - 1.0 / 96.0, product = 1.0 / 120.0 - 1.0 / 96.0;
  EXPECT_NEAR(corner.inertia(0, 0), 2.0 * square, 1e-15);
  EXPECT_NEAR(corner.inertia(0, 1), -product, 1e-15);
}

TEST(MassProperties, TwoBoxesAddUpByTheParallelAxes) {
  const TriMesh first = test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)),
                second = test::makeBox(Vec3(2, 0, 0), Vec3(3, 2, 1));
  const MassProperties both = of(test::joined(first, second));
  EXPECT_NEAR(both.volume, 3.0, 1e-14);
  Mat3 inertia = Mat3::Zero();
  for (const MassProperties& part : {of(first), of(second)}) {
    const Vec3 arm = part.center - both.center;
    inertia += part.inertia + part.volume * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  EXPECT_TRUE(both.inertia.isApprox(inertia, 1e-12));
}

TEST(MassProperties, FollowARigidMotion) {
  const TriMesh torus = test::makeTorus(1.0, 0.3, 24, 12);
  const MassProperties here = of(torus), there = of(moved(torus, kSomewhere));
  const Mat3 turn = kSomewhere.linear();
  EXPECT_NEAR(there.volume, here.volume, 1e-12);
  EXPECT_TRUE(there.center.isApprox(kSomewhere * here.center, 1e-12));
  EXPECT_TRUE(there.inertia.isApprox(turn * here.inertia * turn.transpose(), 1e-12));
}

TEST(MassProperties, PrincipalAxesGiveTheInertiaBack) {
  const MassProperties box = of(moved(test::makeBox(Vec3(-1, -2, -3), Vec3(1, 2, 3)), kSomewhere));
  const PrincipalInertia principal = principalInertia(box.inertia);
  EXPECT_NEAR(principal.axes.determinant(), 1.0, 1e-12);
  EXPECT_TRUE(
      Mat3(principal.axes * principal.moments.asDiagonal() * principal.axes.transpose()).isApprox(box.inertia, 1e-12));
  EXPECT_TRUE(principal.moments.isApprox(48.0 / 12.0 * Vec3(4.0 + 16.0, 4.0 + 36.0, 16.0 + 36.0), 1e-12));
}

}  // namespace
}  // namespace lorica
