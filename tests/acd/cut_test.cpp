#include "acd/cut.h"

#include "acd/half_volumes.h"
#include "acd/separating_plane.h"
#include "acd/small_lp.h"
#include "geometry/convex_hull.h"
#include "geometry/random_numbers.h"
#include "tests/acd/hard_meshes.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace lorica {
namespace {

constexpr double kTolerance = 1e-9;

/// A cut with the positions of all points, new ones included.
struct Cut {
  Cut(const TriMesh& mesh, const Plane& plane)
      : halves(cutPart(test::wholeOf(mesh), mesh.vertices, plane, kTolerance, countOf(mesh.vertices))),
        points(mesh.vertices) {
    test::append(halves.newPoints, points);
  }
  [[nodiscard]] double volumeAbove() const { return signedVolume(points, halves.above.triangles); }
  [[nodiscard]] double volumeBelow() const { return signedVolume(points, halves.below.triangles); }

  CutResult halves;
  std::vector<Vec3> points;
};

/// Independent reference: the volume of a closed mesh below a plane. Every triangle, clipped by the plane, is the base
/// of a pyramid with its apex in the plane. The cap would be the base of a flat pyramid, so it is not needed.
double clippedVolume(const TriMesh& mesh, const Plane& plane) {
  const Vec3 apex = plane.offset * plane.normal;
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    std::vector<Vec3> polygon;
    for (int e = 0; e < 3; ++e) {
      const Vec3 a = mesh.vertices[t[e]] - apex;
      const Vec3 b = mesh.vertices[t[(e + 1) % 3]] - apex;
      const double da = plane.normal.dot(a), db = plane.normal.dot(b);
      if (da <= 0.0) polygon.push_back(a);
      if (da * db < 0.0) polygon.push_back(a + da / (da - db) * (b - a));
    }
    for (std::size_t i = 2; i < polygon.size(); ++i) sum += polygon[0].dot(polygon[i - 1].cross(polygon[i]));
  }
  return sum / 6.0;
}

TEST(Cut, APlaneThatOnlyTouchesThePartCutsNothingOff) {
  EXPECT_TRUE(pointsUsedBy({}).empty());
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 1, 1});
  // Beside the box, through two of its faces, through an edge and through a corner, with the box below.
  for (const Plane& below :
       {Plane{Vec3::UnitX(), 1.5}, Plane{Vec3::UnitX(), 1.0}, Plane{-Vec3::UnitZ(), 0.0},
        Plane{Vec3(1, 1, 0).normalized(), std::sqrt(2.0)}, Plane{Vec3(1, 1, 1).normalized(), std::sqrt(3.0)}}) {
    SCOPED_TRACE(testing::Message() << "normal " << below.normal.transpose() << ", offset " << below.offset);
    const Plane above{-below.normal, -below.offset};
    const CutResult cutBelow = Cut(box, below).halves, cutAbove = Cut(box, above).halves;
    for (const Part& all : {cutBelow.below, cutAbove.above}) {
      EXPECT_EQ(all.triangles, box.triangles);
      EXPECT_EQ(all.sourceTriangle, test::wholeOf(box).sourceTriangle);
      EXPECT_EQ(all.points.size(), 8u);
    }
    for (const Part& none : {cutBelow.above, cutAbove.below}) {
      EXPECT_TRUE(none.triangles.empty());
      EXPECT_TRUE(none.sourceTriangle.empty());
      EXPECT_TRUE(none.points.empty());
    }
    EXPECT_TRUE(cutBelow.newPoints.empty());
    EXPECT_TRUE(cutAbove.newPoints.empty());
  }
}

TEST(PlaneSides, PointsWithinTheToleranceAreOnThePlane) {
  const std::vector<Vec3> points = {{0, 0, 3}, {0, 0, 1}, {0, 0, 1.25}, {0, 0, 1.5}, {0, 0, 2}};
  const Plane plane{Vec3::UnitZ(), 1.25};
  PlaneSides sides;
  Part part;
  part.points = {0, 1, 2, 3, 4};
  sides.classify(part, points, plane, 0.25);
  const std::vector<int> expected = {1, 0, 0, 0, 1};
  for (PointIndex p = 0; p < 5; ++p) {
    EXPECT_EQ(sides.sideOf(p), expected[p]) << p;
    EXPECT_EQ(sides.distanceOf(p), points[p].z() - 1.25) << p;
  }
  EXPECT_EQ(sides.classify(1, points, plane, 0.125), -1);
  EXPECT_EQ(sides.sideOf(1), -1);
  // From z = 3 to z = 1 the plane is at 1/8 of the first point, in whichever order the ends are given.
  for (const CutPoint& c : {sides.crossing(0, 1), sides.crossing(1, 0)}) {
    EXPECT_EQ(c.first, 0);
    EXPECT_EQ(c.second, 1);
    EXPECT_EQ(c.lambda, 0.125);
  }
}

TEST(Cut, PointsOfABoxAreWhereThePlaneMeetsItsEdges) {
  // The vertex numbers of makeBox are binary, x is the lowest digit: the plane x = 1/4 crosses the four edges along x
  // and the diagonals of four sides, each at 3/4 of its even end.
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 1, 1});
  const Cut cut(box, {Vec3::UnitX(), 0.25});
  std::multiset<std::pair<PointIndex, PointIndex>> edges;  // an edge has one cut point, shared by both triangles
  for (const CutPoint& c : cut.halves.newPoints) {
    edges.insert({c.first, c.second});
    EXPECT_EQ(c.lambda, 0.75);
  }
  EXPECT_EQ(edges, (std::multiset<std::pair<PointIndex, PointIndex>>{
                       {0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 3}, {4, 7}, {0, 5}, {2, 7}}));
  EXPECT_EQ(cut.volumeBelow(), 0.25);
  EXPECT_EQ(cut.volumeAbove(), 0.75);
  EXPECT_EQ(cut.halves.below.points, (std::vector<PointIndex>{0, 2, 4, 6, 8, 9, 10, 11, 12, 13, 14, 15}));
}

TEST(Cut, CapsAreThoseOfClosedForms) {
  struct Case {
    const char* name;
    TriMesh mesh;
    Plane plane;
    double volumeBelow, volumeAbove, capArea;
  };
  const TriMesh l = test::makeLShape();
  const Vec3 xy = Vec3(1, 1, 0).normalized();
  const Plane slanted{Vec3(1, 1, 1).normalized(), 2.0 / 3.0 / std::sqrt(3.0)};
  const std::vector<Case> cases = {
      // The corner cut off is the tetrahedron reduced to 2/3; its base is a triangle of side 2/3 sqrt(2).
      {"tetrahedron", test::makeTetrahedron(), slanted, 8.0 / 162.0, 19.0 / 162.0, std::sqrt(3.0) * 2.0 / 9.0},
      {"L-shape, along the inner face", l, {Vec3::UnitX(), 1.0}, 2.0, 1.0, 1.0},
      {"L-shape, across both arms", l, {xy, 2.5 * std::sqrt(0.5)}, 2.75, 0.25, std::sqrt(2.0)},
      {"L-shape, its bisector", l, {Vec3(1, -1, 0).normalized(), 0.0}, 1.5, 1.5, std::sqrt(2.0)},
      {"hollow box, through the cavity", test::makeHollowBox(), {Vec3::UnitY(), 1.5}, 13.0, 13.0, 8.0},
      // The cavity's side in the plane closes the lower half there, so the cap has a hole.
      {"hollow box, along the cavity's side", test::makeHollowBox(), {Vec3::UnitY(), 1.0}, 9.0, 17.0, 8.0}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const Cut cut(c.mesh, c.plane);
    EXPECT_NEAR(cut.volumeBelow(), c.volumeBelow, 1e-12);
    EXPECT_NEAR(cut.volumeAbove(), c.volumeAbove, 1e-12);
    for (const Part* half : {&cut.halves.above, &cut.halves.below}) {
      EXPECT_TRUE(test::isClosed(half->triangles));
      EXPECT_NEAR(surfaceArea(cut.points, test::capsOf(*half)), c.capArea, 1e-12);
    }
  }
}

TEST(Cut, AnyPlaneLeavesTwoClosedHalvesAndEveryTriangleOnce) {
  test::Dice dice(11);
  for (const TriMesh& mesh : {test::makeLShape(), test::makeHollowBox(), test::makeTorus(1.0, 0.4, 16, 9),
                              test::joined(test::makeSphere(1.0, 7, 9), test::makeBox({1, 1, 1}, {2, 3, 2}))}) {
    const double volume = signedVolume(mesh.vertices, mesh.triangles);
    for (const Plane& plane : test::planesThrough(mesh.vertices, dice, 60)) {
      SCOPED_TRACE(testing::Message() << mesh.triangles.size() << " triangles, normal " << plane.normal.transpose()
                                      << ", offset " << plane.offset);
      const Cut cut(mesh, plane);
      EXPECT_NEAR(cut.volumeBelow(), clippedVolume(mesh, plane), 1e-9 * volume);
      EXPECT_NEAR(cut.volumeBelow() + cut.volumeAbove(), volume, 1e-12 * volume);

      // All pieces of an input triangle together have its area, and lie on the side of their half.
      std::vector<double> left(mesh.triangles.size());
      for (std::size_t i = 0; i < left.size(); ++i) {
        left[i] = surfaceArea(mesh.vertices, std::span(mesh.triangles).subspan(i, 1));
      }
      for (const auto& [half, side] : {std::pair{&cut.halves.above, 1.0}, std::pair{&cut.halves.below, -1.0}}) {
        EXPECT_TRUE(test::isClosed(half->triangles));
        EXPECT_EQ(half->points, pointsUsedBy(half->triangles));
        ASSERT_EQ(half->sourceTriangle.size(), half->triangles.size());
        for (const PointIndex p : half->points) {
          EXPECT_GE(side * (plane.normal.dot(cut.points[p]) - plane.offset), -kTolerance) << p;
        }
        for (std::size_t i = 0; i < half->triangles.size(); ++i) {
          if (half->sourceTriangle[i] < 0) continue;
          left[half->sourceTriangle[i]] -= surfaceArea(cut.points, std::span(half->triangles).subspan(i, 1));
        }
      }
      for (std::size_t i = 0; i < left.size(); ++i) EXPECT_NEAR(left[i], 0.0, 1e-12) << "triangle " << i;

      // Both halves have the same cap, one of them reversed.
      const std::vector<Triangle> reversed = test::insideOut({{}, test::capsOf(cut.halves.below)}).triangles;
      EXPECT_EQ(test::capsOf(cut.halves.above), reversed);
      // Without it the area vectors add up to the area that it has to fill, unless its triangles overlap.
      Vec3 open = Vec3::Zero();
      for (std::size_t i = 0; i < cut.halves.above.triangles.size(); ++i) {
        const Triangle& t = cut.halves.above.triangles[i];
        if (cut.halves.above.sourceTriangle[i] < 0) continue;
        open += 0.5 * (cut.points[t[1]] - cut.points[t[0]]).cross(cut.points[t[2]] - cut.points[t[0]]);
      }
      EXPECT_NEAR(surfaceArea(cut.points, reversed), plane.normal.dot(open), 1e-9);

      // A rigid motion only moves the points.
      const Quat rotation = dice.rotation();
      const Vec3 shift = dice.inBox(5.0), normal = rotation * plane.normal;
      const Cut again(test::moved(mesh, [&](const Vec3& v) -> Vec3 { return rotation * v + shift; }),
                      {normal, plane.offset + normal.dot(shift)});
      EXPECT_EQ(again.halves.above.sourceTriangle, cut.halves.above.sourceTriangle);
      EXPECT_EQ(again.halves.below.sourceTriangle, cut.halves.below.sourceTriangle);
      ASSERT_EQ(again.points.size(), cut.points.size());
      for (std::size_t i = 0; i < cut.points.size(); ++i) {
        EXPECT_LT((rotation * cut.points[i] + shift - again.points[i]).norm(), 1e-9) << "point " << i;
      }
    }
  }
}

TEST(Cut, EighthsOfABoxKeepTheirShareInEveryAffinePose) {
  // Cut three times: the points of later cuts lie between those of earlier ones. An affine map keeps ratios, so the
  // shares stay the same although the cut points are computed only from the mapped vertices.
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 1, 1});
  std::vector<Vec3> points = box.vertices, mapped;
  const Mat3 map{{2, 1, 0}, {0, 3, 1}, {1, 0, 4}};  // determinant 25
  for (const Vec3& v : box.vertices) mapped.push_back(map * v + Vec3(5, 6, 7));
  struct Share {
    Part part;
    double volume;
  };
  std::vector<Share> parts = {{test::wholeOf(box), 1.0}};
  const std::array<double, 3> offsets = {0.25, 0.5, 0.625};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Share> next;
    for (const Share& whole : parts) {
      CutResult cut = cutPart(whole.part, points, {Vec3::Unit(axis), offsets[axis]}, kTolerance, countOf(points));
      test::append(cut.newPoints, points);
      test::append(cut.newPoints, mapped);
      next.push_back({std::move(cut.below), whole.volume * offsets[axis]});
      next.push_back({std::move(cut.above), whole.volume * (1.0 - offsets[axis])});
    }
    parts = std::move(next);
  }
  ASSERT_EQ(parts.size(), 8u);
  for (const auto& [part, volume] : parts) {
    EXPECT_TRUE(test::isClosed(part.triangles));
    EXPECT_NEAR(signedVolume(points, part.triangles), volume, 1e-12);
    EXPECT_NEAR(signedVolume(mapped, part.triangles), 25.0 * volume, 1e-11);
  }
}

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

/// A torus in two keyframes, with planes through vertices, along faces, and at arbitrary positions.
struct Halves : ::testing::Test {
  Halves() : mesh(test::makeTorus(1.0, 0.4, 120, 60)), keyframes(2, mesh.vertices), whole(test::wholeOf(mesh)) {
    for (Vec3& v : keyframes[1]) v.y() += 0.3 * std::sin(2.0 * v.x());
  }
  /// Hull volumes of the halves that the cut actually produces.
  std::pair<double, double> truth(const Plane& plane, std::size_t k) const {
    const CutResult cut = cutPart(whole, mesh.vertices, plane, 1e-9, countOf(mesh.vertices));
    std::vector<Vec3> all = keyframes[k];
    test::append(cut.newPoints, all);
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
    const auto first = truth(plane, 0), second = truth(plane, 1);
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
