#include "acd/transfer.h"

#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica {
namespace {

using test::transferred;

/// An L-shape with a long arm as one part, and cut along an inner face into boxes of 1 x 2 x 1 and 4 x 1 x 1.
struct LongLShape : ::testing::Test {
  LongLShape() {
    whole.vertexCount = halves.vertexCount = countOf(mesh.vertices);
    whole.triangleCount = halves.triangleCount = countOf(mesh.triangles);
    whole.parts = {test::wholeOf(mesh)};
    CutResult cut = cutPart(whole.parts[0], mesh.vertices, {Vec3::UnitX(), 1.0}, 1e-9, halves.vertexCount);
    halves.cutPoints = std::move(cut.newPoints);
    halves.parts = {std::move(cut.below), std::move(cut.above)};
    halves.splitFrom = {0};
  }
  [[nodiscard]] std::vector<Vec3> posed(auto map) const { return test::moved(mesh, map).vertices; }

  TriMesh mesh =
      test::moved(test::makeLShape(), [](const Vec3& v) { return Vec3(v.x() > 1.5 ? 5.0 : v.x(), v.y(), v.z()); });
  Decomposition whole, halves;
};

double hullVolume(std::span<const PointIndex> ids, std::span<const Vec3> points) {
  return convexHullVolume(test::chosen(ids, points));
}

TEST(Transfer, CutPointsFollowInTheOrderOfTheirCreation) {
  Decomposition d;
  transfer(d, {}, {});
  d.vertexCount = 3;
  const std::vector<Vec3> posed = {{0, 0, 0}, {4, 0, 0}, {0, 8, 0}};
  EXPECT_EQ(transferred(d, posed), posed);
  d.cutPoints = {{0, 1, 0.25}, {2, 3, 0.5}};
  const std::vector<Vec3> points = transferred(d, posed);
  EXPECT_EQ(points[3], Vec3(3, 0, 0));
  EXPECT_EQ(points[4], Vec3(1.5, 4, 0));
}

TEST_F(LongLShape, TransferWorksInPlaceAndKeepsRatios) {
  // The crossings of the plane x = 1 stay at a fifth of their edges in any affine pose.
  ASSERT_EQ(halves.cutPoints.size(), 3u);
  const Mat3 map{{2, 1, 0}, {0, 3, 1}, {1, 0, 4}};
  const std::vector<Vec3> pose = posed([&](const Vec3& v) -> Vec3 { return map * v + Vec3(5, 6, 7); });
  const std::vector<Vec3> still = transferred(halves, mesh.vertices), points = transferred(halves, pose);
  ASSERT_EQ(points.size(), 15u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((map * still[i] + Vec3(5, 6, 7) - points[i]).norm(), 1e-12) << i;
  }
  for (std::size_t i = 12; i < 15; ++i) EXPECT_NEAR(still[i].x(), 1.0, 1e-15);
  std::vector<Vec3> inPlace = pose;
  inPlace.resize(points.size(), Vec3(9, 9, 9));
  transfer(halves, std::span(inPlace).first(pose.size()), inPlace);
  EXPECT_EQ(inPlace, points);
}

TEST(Transfer, PosedSurfaceStaysInsideTheHullsInEveryPose) {
  const TriMesh mesh = test::makeTorus(1.0, 0.4, 20, 10);
  const Decomposition d = test::decomposed(mesh, {.maxParts = 8});
  test::Dice dice(99);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Vec3> posed = mesh.vertices;
    for (Vec3& v : posed) v += dice.inBox(0.25);  // a pose outside the training
    const std::vector<ConvexHull> hulls = partHulls(d, transferred(d, posed));
    for (int sample = 0; sample < 200; ++sample) {
      const Triangle& t = dice.oneOf(mesh.triangles);
      const double a = dice.unit();
      const double b = dice.unit() * (1 - a);
      const Vec3 p = a * posed[t[0]] + b * posed[t[1]] + (1 - a - b) * posed[t[2]];
      double outside = 1e9;
      for (const ConvexHull& hull : hulls) outside = std::min(outside, largestViolation(hull, std::span(&p, 1)));
      EXPECT_LE(outside, 1e-9) << "trial " << trial;
    }
  }
}

TEST(SpanningPoints, LeaveOutBlendsEvenOfPointsThatThePartHasNot) {
  Decomposition d;
  d.vertexCount = 4;
  d.cutPoints = {{0, 1, 0.5}, {2, 4, 0.5}, {3, 4, 0.25}, {5, 6, 0.5}};  // points 4 to 7
  using Points = std::vector<PointIndex>;
  for (const auto& [points, spanning] : std::initializer_list<std::pair<Points, Points>>{
           {{}, {}},
           {{0, 1, 2, 3}, {0, 1, 2, 3}},
           {{0, 4}, {0, 4}},  // one end only
           {{0, 1, 4}, {0, 1}},
           {{2, 4, 5, 6}, {2, 4, 6}},
           {{5, 6, 7}, {5, 6}},
           // 4 is not a point of the part, but as a blend of 0 and 1 it is in the part's hull; so are all others.
           {{0, 1, 2, 5}, {0, 1, 2}},
           {{0, 1, 2, 3, 7}, {0, 1, 2, 3}}}) {
    EXPECT_EQ(spanningPoints(d, {{}, {}, points}), spanning) << testing::PrintToString(points);
  }
}

TEST(SpanningPoints, HaveThePartsHullInEveryPose) {
  test::Dice dice(51);
  TriMesh torus = test::makeTorus(1.0, 0.4, 24, 10);
  for (Vec3& v : torus.vertices) v += dice.inBox(0.02);  // no plane of symmetry, which would need no cut points
  // Cut into more parts than wanted, then merged again: that leaves blends.
  std::size_t all = 0, kept = 0;
  for (int parts = 2; parts <= 12; parts += 2) {
    const Decomposition d = test::decomposed(torus, {.maxParts = parts, .preset = DecomposePreset::kFast});
    for (const Part& part : d.parts) {
      const std::vector<PointIndex> spanning = spanningPoints(d, part);
      EXPECT_TRUE(std::is_sorted(spanning.begin(), spanning.end()));
      EXPECT_TRUE(std::includes(part.points.begin(), part.points.end(), spanning.begin(), spanning.end()));
      all += part.points.size();
      kept += spanning.size();
      for (int trial = 0; trial < 20; ++trial) {
        std::vector<Vec3> posed = torus.vertices;
        for (Vec3& v : posed) v += dice.inBox(0.5);
        const std::vector<Vec3> points = transferred(d, posed);
        const double volume = hullVolume(part.points, points);
        EXPECT_NEAR(hullVolume(spanning, points), volume, 1e-9 * volume);
      }
    }
  }
  EXPECT_LT(kept, all);
}

TEST_F(LongLShape, HullsAreThoseOfThePartsInOrder) {
  EXPECT_TRUE(partHulls({}, {}).empty());
  const std::vector<Vec3> flat = transferred(halves, posed([](const Vec3& v) { return Vec3(v.x(), v.y(), 0); }));
  for (const ConvexHull& hull : partHulls(halves, flat)) {
    EXPECT_TRUE(hull.degenerate());
    EXPECT_EQ(hull.volume, 0.0);
  }
  const std::vector<Vec3> points = transferred(halves, mesh.vertices);
  const std::vector<ConvexHull> hulls = partHulls(halves, points);
  ASSERT_EQ(hulls.size(), 2u);
  EXPECT_NEAR(hulls[0].volume, 2.0, 1e-12);
  EXPECT_NEAR(hulls[1].volume, 4.0, 1e-12);
  for (std::size_t i = 0; i < 2; ++i) {
    const ConvexHull alone = partHull(halves.parts[i], points);
    EXPECT_EQ(alone.vertices, hulls[i].vertices);
    EXPECT_EQ(alone.triangles, hulls[i].triangles);
    EXPECT_EQ(alone.vertices.size(), 8u) << "the corners of a box";
  }
}

TEST_F(LongLShape, ErrorInAPoseIsThatOfClosedForms) {
  const auto same = [](const Vec3& v) { return v; };
  // The hull adds the triangle between the arms, of area 2.
  const auto expectError = [&](const Decomposition& d, auto map, double meshVolume, double hullVolume,
                               double relative) {
    const PoseError error = errorInPose(d, mesh, posed(map));
    EXPECT_NEAR(error.meshVolume, meshVolume, 1e-12 * meshVolume);
    EXPECT_NEAR(error.hullVolume, hullVolume, 1e-12 * hullVolume);
    EXPECT_NEAR(error.relative(), relative, 1e-12);
  };
  expectError(whole, same, 6.0, 8.0, 1.0 / 3.0);
  expectError(halves, same, 6.0, 6.0, 0.0);
  // Stretched and sheared: volumes grow by 2 * 3 * 4, and boxes stay convex.
  const auto sheared = [](const Vec3& v) { return Vec3(2.0 * v.x() + v.y(), 3.0 * v.y(), 4.0 * v.z() - v.x()); };
  expectError(whole, sheared, 24.0 * 6.0, 24.0 * 8.0, 1.0 / 3.0);
  expectError(halves, sheared, 24.0 * 6.0, 24.0 * 6.0, 0.0);
  // The arm pulled out to x = 9: its lower edge is now cut at c = (1.8, 0), still at a fifth, and its upper one still
  // at vertex 3, (1, 1). The hulls' profiles are 0 c 4 5, of area 2.8, and c 1 2 3, of area 7.6: they overlap and leave
  // nothing out.
  //
  //   5---4
  //   |   |
  //   |   3---------2
  //   |             |
  //   0-----c-------1
  const auto pulled = [](const Vec3& v) { return Vec3(v.x() > 1.5 ? 9.0 : v.x(), v.y(), v.z()); };
  expectError(halves, pulled, 10.0, 10.4, 0.04);
}

}  // namespace
}  // namespace lorica
