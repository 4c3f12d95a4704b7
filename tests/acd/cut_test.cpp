#include "acd/cut.h"

#include "tests/acd/hard_meshes.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

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

}  // namespace
}  // namespace lorica
