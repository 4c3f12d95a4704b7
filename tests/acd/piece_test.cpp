#include "acd/piece.h"

#include "tests/acd/hard_meshes.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

/// All positions of a mesh in several keyframes, each the mesh's own pose after a map.
template <class... Maps>
std::vector<Vec3> keyframesOf(const TriMesh& mesh, Maps... maps) {
  std::vector<Vec3> positions;
  const auto add = [&](auto map) { positions.insert(positions.end(), map.begin(), map.end()); };
  (add(test::moved(mesh, maps).vertices), ...);
  return positions;
}

CutContext contextOf(const TriMesh& mesh, const std::vector<Vec3>& positions) {
  return {mesh, {positions, countOf(mesh.vertices)}};
}

/// Cuts a part, and adds the new points to the context.
std::array<Part, 2> cut(const Part& part, CutContext& context, const Plane& plane) {
  CutResult halves = cutPart(part, context.points[0], plane, context.onPlane[0], context.pointCount());
  context.addCutPoints(halves.newPoints);
  return {std::move(halves.below), std::move(halves.above)};
}

/// As unite(), which takes a span: for lists of parts written out.
Part united(const std::vector<const Part*>& parts) {
  return unite(parts);
}

double areaOfCaps(const Part& part, const CutContext& context) {
  return surfaceArea(context.points[0], test::capsOf(part));
}

TEST(CutContext, FlatTrianglesHaveNoNormalAndNoVolume) {
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 2, 3});
  const auto same = [](const Vec3& v) { return v; };
  const auto doubled = [](const Vec3& v) -> Vec3 { return 2.0 * v; };
  const auto flat = [](const Vec3& v) { return Vec3(v.x(), 0, v.z()); };
  const std::vector<Vec3> positions = keyframesOf(box, same, doubled, flat);
  const CutContext context = contextOf(box, positions);
  ASSERT_EQ(context.keyframeCount(), 3u);
  EXPECT_EQ(context.pointCount(), 8);
  EXPECT_TRUE(context.cutPoints.empty());
  EXPECT_DOUBLE_EQ(context.meshVolume[0], 6.0);
  EXPECT_DOUBLE_EQ(context.meshVolume[1], 48.0);
  EXPECT_EQ(context.meshVolume[2], 0.0);
  for (std::size_t i = 0; i < box.triangles.size(); ++i) {
    const Triangle& t = box.triangles[i];
    // An outward normal leads away from the centre, along one axis.
    const Vec3 normal = context.normals[0][i];
    EXPECT_EQ(normal.cwiseAbs().sum(), 1.0);
    EXPECT_GT(normal.dot(box.vertices[t[0]] - Vec3(0.5, 1, 1.5)), 0.0);
    EXPECT_EQ(context.normals[1][i], normal);
    // Without its height the box has only its bottom and top.
    EXPECT_EQ(context.normals[2][i], normal.y() == 0.0 ? Vec3(0, 0, 0) : normal);
  }
}

TEST(CutContext, CoplanarVerticesStayOnTheirPlaneFarFromTheOrigin) {
  test::Dice dice(31);
  const TriMesh shape = test::makeLShape();
  for (const double distance : {0.0, 10.0, 1e5, 1e9}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Quat rotation = dice.rotation();
      const Vec3 shift = distance * (rotation * Vec3::UnitX()) + dice.inBox(1.0);
      const std::vector<Vec3> positions =
          keyframesOf(shape, [&](const Vec3& v) -> Vec3 { return rotation * v + shift; });
      const CutContext context = contextOf(shape, positions);
      EXPECT_LT(context.onPlane[0], 1e-8 + 1e-14 * distance);
      // The planes of the inner faces, x = 1 and y = 1, contain four vertices each, and the bottom, z = 0, six.
      for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        const double level = axis.z() == 0.0 ? 1.0 : 0.0;
        const Vec3 normal = rotation * axis;
        const double offset = normal.dot(rotation * (level * axis) + shift);
        for (std::size_t i = 0; i < positions.size(); ++i) {
          const bool onPlane = std::abs(normal.dot(positions[i]) - offset) <= context.onPlane[0];
          EXPECT_EQ(onPlane, axis.dot(shape.vertices[i]) == level) << "vertex " << i << " at " << distance;
        }
      }
    }
  }
}

TEST(CutContext, CutPointsFollowTheirEndsInEveryKeyframe) {
  const TriMesh mesh = test::makeTetrahedron();
  const auto same = [](const Vec3& v) { return v; };
  const auto moved = [](const Vec3& v) { return Vec3(4.0 * v.y() + 1.0, 8.0 * v.x(), -2.0 * v.z()); };
  const std::vector<Vec3> positions = keyframesOf(mesh, same, moved);
  CutContext context = contextOf(mesh, positions);
  context.addCutPoints(std::vector<CutPoint>{{0, 1, 0.25}, {2, 4, 0.5}});  // the second needs the first
  context.addCutPoints(std::vector<CutPoint>{{3, 5, 0.75}});
  EXPECT_EQ(context.pointCount(), 7);
  ASSERT_EQ(context.cutPoints.size(), 3u);
  EXPECT_EQ(context.cutPoints[2].second, 5);
  const std::vector<Vec3> expected = {{0.75, 0, 0}, {0.375, 0.5, 0}, {0.09375, 0.125, 0.75}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(context.points[0][4 + i], expected[i]);
    EXPECT_EQ(context.points[1][4 + i], moved(expected[i])) << "an affine map keeps ratios";
  }
}

TEST(Piece, IsMeasuredInEveryKeyframe) {
  const TriMesh mesh = test::makeLShape();
  const auto same = [](const Vec3& v) { return v; };
  const auto doubled = [](const Vec3& v) -> Vec3 { return 2.0 * v; };
  const auto flat = [](const Vec3& v) { return Vec3(v.x(), v.y(), 0); };
  // The outer corner pulled in to the inner one: a box of 1 x 2 x 1 is left.
  const auto folded = [](const Vec3& v) { return Vec3(std::min(v.x(), 1.0), v.y(), v.z()); };
  const std::vector<Vec3> positions = keyframesOf(mesh, same, doubled, flat, folded);
  const CutContext context = contextOf(mesh, positions);
  const Piece piece = measure(test::wholeOf(mesh), context);
  // The hull adds a prism over the triangle between the arms, of area 1/2.
  const std::vector<double> volumes = {3.0, 24.0, 0.0, 2.0}, hullVolumes = {3.5, 28.0, 0.0, 2.0};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(piece.volume[k], volumes[k], 1e-12) << k;
    EXPECT_NEAR(piece.hullVolume[k], hullVolumes[k], 1e-12) << k;
    EXPECT_NEAR(piece.error(k), hullVolumes[k] - volumes[k], 1e-12) << k;
  }
  EXPECT_NEAR(piece.totalError(), 4.5, 1e-12);
  EXPECT_NEAR(piece.totalHullVolume(), 33.5, 1e-12);
  // All but the inner corners, 3 and 9.
  const std::vector<PointIndex> outer = {0, 1, 2, 4, 5, 6, 7, 8, 10, 11};
  EXPECT_EQ(piece.hullPoints[0], outer);
  EXPECT_EQ(piece.hullPoints[1], outer);
  EXPECT_EQ(piece.part.points.size(), 12u);
}

TEST(Unite, RestoresWhatWasCut) {
  // A bar cut at x = 1 and x = 2: slabs 0 and 1 share a cap, and so do 1 and 2, but not 0 and 2.
  const TriMesh bar = test::makeBox({0, 0, 0}, {3, 2, 1});
  const std::vector<Vec3> positions = bar.vertices;
  CutContext context = contextOf(bar, positions);
  EXPECT_TRUE(united({}).triangles.empty());
  EXPECT_TRUE(united({}).points.empty());

  const auto [first, rest] = cut(test::wholeOf(bar), context, {Vec3::UnitX(), 1.0});
  const auto [second, third] = cut(rest, context, {Vec3::UnitX(), 2.0});
  struct Case {
    std::vector<const Part*> parts;
    double volume, capArea;
  };
  for (const Case& c : {Case{{&second}, 2.0, 4.0}, Case{{&first, &second}, 4.0, 2.0}, Case{{&third, &second}, 4.0, 2.0},
                        Case{{&first, &third}, 4.0, 4.0}, Case{{&third, &first, &second}, 6.0, 0.0}}) {
    SCOPED_TRACE(testing::Message() << c.parts.size() << " parts, volume " << c.volume << ", caps " << c.capArea);
    const Part whole = united(c.parts);
    EXPECT_NEAR(signedVolume(context.points[0], whole.triangles), c.volume, 1e-12);
    EXPECT_NEAR(areaOfCaps(whole, context), c.capArea, 1e-12);
    EXPECT_TRUE(test::isClosed(whole.triangles));
    EXPECT_EQ(whole.points, pointsUsedBy(whole.triangles));
    EXPECT_EQ(whole.sourceTriangle.size(), whole.triangles.size());
  }
  const Part alone = united({&second});
  EXPECT_EQ(alone.triangles, second.triangles);
  EXPECT_EQ(alone.sourceTriangle, second.sourceTriangle);
}

TEST(Unite, IsClosedAndKeepsTheSurfaceForAnyCuts) {
  test::Dice dice(32);
  const TriMesh torus = test::makeTorus(1.0, 0.4, 24, 10);
  for (int trial = 0; trial < 10; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial);
    CutContext context = contextOf(torus, torus.vertices);
    std::vector<Part> parts = {test::wholeOf(torus)};
    for (int cuts = 0; cuts < 3; ++cuts) {
      const Plane plane{dice.inBox(1.0).normalized(), dice.between(-0.3, 0.3)};
      std::vector<Part> next;
      for (const Part& part : parts) {
        for (Part& half : cut(part, context, plane)) next.push_back(std::move(half));
      }
      parts = std::move(next);
    }
    // In random order, one part more each time. A cap that a later cut divided on one side only does not cancel.
    for (std::size_t i = parts.size(); i-- > 1;) {
      std::swap(parts[i], parts[static_cast<std::size_t>(dice.whole(0, static_cast<int>(i)))]);
    }
    std::vector<const Part*> some;
    double volume = 0.0, surface = 0.0, caps = 0.0;
    Part stepwise;
    for (const Part& part : parts) {
      some.push_back(&part);
      volume += signedVolume(context.points[0], part.triangles);
      caps += areaOfCaps(part, context);
      surface += surfaceArea(context.points[0], part.triangles) - areaOfCaps(part, context);
      stepwise = united({&stepwise, &part});
      for (const Part& whole : {unite(some), stepwise}) {
        const double capArea = areaOfCaps(whole, context);
        EXPECT_TRUE(test::isClosed(whole.triangles));
        EXPECT_EQ(whole.points, pointsUsedBy(whole.triangles));
        EXPECT_NEAR(signedVolume(context.points[0], whole.triangles), volume, 1e-12);
        EXPECT_NEAR(surfaceArea(context.points[0], whole.triangles) - capArea, surface, 1e-12);
        EXPECT_LE(capArea, caps + 1e-12);
      }
    }
    EXPECT_NEAR(volume, signedVolume(torus.vertices, torus.triangles), 1e-12);
    EXPECT_NEAR(surface, surfaceArea(torus.vertices, torus.triangles), 1e-11);
    EXPECT_LT(areaOfCaps(stepwise, context), 0.5 * caps) << "most caps are shared";
  }
}

}  // namespace
}  // namespace lorica
