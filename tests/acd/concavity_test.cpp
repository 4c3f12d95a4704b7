#include "acd/concavity.h"

#include "acd/decompose.h"
#include "acd/part_concavity.h"
#include "acd/transfer.h"
#include "geometry/counts.h"
#include "geometry/triangle_tree.h"
#include "tests/acd/hard_meshes.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

namespace lorica::test {
namespace {

std::vector<ConcaveEdge> concaveEdgesOf(const TriMesh& mesh, const Part& part, std::span<const Vec3> points, int count,
                                        double spacing) {
  return deepestConcaveEdges(creasesOf(part), mesh.triangles, unitNormals(mesh.triangles, points), points,
                             convexHull(test::chosen(part.points, points)), count, spacing);
}

std::vector<ConcaveEdge> concaveEdgesOf(const TriMesh& mesh, int count = 1000, double spacing = 0.0) {
  return concaveEdgesOf(mesh, test::wholeOf(mesh), mesh.vertices, count, spacing);
}

/// Independent reference: the midpoints of all edges of unit cubes that exactly three cubes surround.
std::set<std::array<double, 3>> concaveMidpoints(const std::set<test::Voxel>& voxels) {
  std::set<std::array<double, 3>> midpoints;
  for (const test::Voxel& cube : voxels) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int corner = 0; corner < 4; ++corner) {
        test::Voxel at = cube;  // the lower end of an edge along the axis
        at[(axis + 1) % 3] += corner & 1;
        at[(axis + 2) % 3] += corner >> 1;
        int around = 0;
        for (int other = 0; other < 4; ++other) {
          test::Voxel near = at;
          near[(axis + 1) % 3] -= other & 1;
          near[(axis + 2) % 3] -= other >> 1;
          around += voxels.contains(near) ? 1 : 0;
        }
        if (around != 3) continue;
        std::array<double, 3> middle = {1.0 * at[0], 1.0 * at[1], 1.0 * at[2]};
        middle[axis] += 0.5;
        midpoints.insert(middle);
      }
    }
  }
  return midpoints;
}

TEST(Creases, AreAllEdgesOfTheMeshButNotTheBordersOfCaps) {
  EXPECT_TRUE(creasesOf({}).empty());
  const TriMesh mesh = test::makeLShape();
  // Cut through the inner edge and all others along z, at a third of their length.
  const CutResult cut = cutPart(test::wholeOf(mesh), mesh.vertices, {Vec3::UnitZ(), 1.0 / 3.0}, 1e-9, 12);
  for (const Part& part : {test::wholeOf(mesh), cut.below, cut.above}) {
    const std::vector<Crease> creases = creasesOf(part);
    // Slow reference: every pair of triangles with the same edge in opposite directions.
    std::set<std::array<int, 4>> expected, found;
    for (std::size_t i = 0; i < part.triangles.size(); ++i) {
      for (std::size_t j = 0; j < part.triangles.size(); ++j) {
        const std::int32_t left = part.sourceTriangle[i], right = part.sourceTriangle[j];
        if (left < 0 || right < 0 || left == right) continue;
        for (int e = 0; e < 9; ++e) {
          const Triangle &s = part.triangles[i], &t = part.triangles[j];
          const PointIndex from = s[e / 3], to = s[(e / 3 + 1) % 3];
          if (from < to && t[e % 3] == to && t[(e % 3 + 1) % 3] == from) expected.insert({from, to, left, right});
        }
      }
    }
    for (const Crease& c : creases) {
      found.insert(c.from < c.to ? std::array<int, 4>{c.from, c.to, c.left, c.right}
                                 : std::array<int, 4>{c.to, c.from, c.right, c.left});
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found.size(), creases.size());
  }
  // 20 triangles have 30 edges.
  EXPECT_EQ(creasesOf(test::wholeOf(mesh)).size(), 30u);
}

TEST(ConcaveEdges, AConvexPartHasNone) {
  for (const TriMesh& mesh :
       {test::makeTetrahedron(), test::makeBox({0, 0, 0}, {1, 2, 3}), test::makeSphere(1.0, 9, 14)}) {
    EXPECT_TRUE(concaveEdgesOf(mesh).empty());
  }
  // The L-shape has one; when it is flat, no angle has a meaning.
  const TriMesh shape = test::makeLShape();
  const TriMesh flat = test::moved(shape, [](const Vec3& v) { return Vec3(v.x(), v.y(), 0.0); });
  EXPECT_EQ(concaveEdgesOf(shape).size(), 1u);
  EXPECT_TRUE(concaveEdgesOf(shape, test::wholeOf(shape), flat.vertices, 1000, 0.0).empty());
}

TEST(ConcaveEdges, OfCubesAreThoseWithThreeCubesAround) {
  // A cross with arms of different length in all six directions, and a staircase.
  std::set<test::Voxel> cross, stairs;
  for (int i = -1; i <= 2; ++i) cross.insert({i, 0, 0});
  for (int i = -3; i <= 1; ++i) cross.insert({0, i, 0});
  for (int i = -2; i <= 4; ++i) cross.insert({0, 0, i});
  for (int x = 0; x < 5; ++x) {
    for (int y = 0; y <= x; ++y) stairs.insert({x, y, 0});
  }
  for (const std::set<test::Voxel>& voxels : {cross, stairs}) {
    const TriMesh mesh = test::makeVoxelSurface(voxels);
    const ConvexHull hull = convexHull(mesh.vertices);
    const std::vector<ConcaveEdge> edges = concaveEdgesOf(mesh);
    std::set<std::array<double, 3>> midpoints;
    double last = std::numeric_limits<double>::infinity();
    for (const ConcaveEdge& edge : edges) {
      EXPECT_TRUE(midpoints.insert({edge.point.x(), edge.point.y(), edge.point.z()}).second);
      double depth = std::numeric_limits<double>::infinity();
      for (const Triangle& t : hull.triangles) {
        const Vec3& a = hull.vertices[t[0]];
        const Vec3 normal = (hull.vertices[t[1]] - a).cross(hull.vertices[t[2]] - a).normalized();
        depth = std::min(depth, normal.dot(a - edge.point));
      }
      EXPECT_NEAR(edge.depth, depth, 1e-12);
      EXPECT_LE(edge.depth, last + 1e-12) << "deepest first";
      last = edge.depth;
      // Perpendicular faces, the left one on the left of the edge, and the solid in the other three quarters.
      EXPECT_NEAR(edge.direction.norm(), 1.0, 1e-12);
      EXPECT_NEAR((edge.rightNormal.cross(edge.leftNormal) - edge.direction).norm(), 0.0, 1e-12);
      const Vec3 empty = edge.point + 0.25 * (edge.leftNormal + edge.rightNormal);
      EXPECT_FALSE(voxels.contains({static_cast<int>(std::floor(empty.x())), static_cast<int>(std::floor(empty.y())),
                                    static_cast<int>(std::floor(empty.z()))}));
    }
    EXPECT_EQ(midpoints, concaveMidpoints(voxels));
    // The first few of all are those that are returned if only a few are wanted.
    for (const int count : {0, 1, 3}) {
      const std::vector<ConcaveEdge> few = concaveEdgesOf(mesh, count);
      ASSERT_EQ(few.size(), static_cast<std::size_t>(count));
      for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].point, edges[i].point);
    }
  }
}

TEST(ConcaveEdges, KeepTheirDistanceAndOneSectionOfEach) {
  // All edges of a cube with an arm on every side: 12 in number, all at the depth of the slanted faces.
  const TriMesh cross =
      test::makeVoxelSurface({{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
  const std::vector<ConcaveEdge> all = concaveEdgesOf(cross);
  ASSERT_EQ(all.size(), 12u);
  for (const ConcaveEdge& edge : all) EXPECT_NEAR(edge.depth, std::sqrt(0.5), 1e-12);
  for (const double spacing : {0.6, 0.8, 1.2, 9.0}) {
    const std::vector<ConcaveEdge> some = concaveEdgesOf(cross, 1000, spacing);
    for (const ConcaveEdge& edge : all) {
      const auto inReach = std::count_if(some.begin(), some.end(),
                                         [&](const ConcaveEdge& e) { return (e.point - edge.point).norm() < spacing; });
      const bool kept =
          std::any_of(some.begin(), some.end(), [&](const ConcaveEdge& e) { return e.point == edge.point; });
      EXPECT_GE(inReach, 1) << "left out without a reason, at spacing " << spacing;
      EXPECT_TRUE(!kept || inReach == 1) << "only itself, at spacing " << spacing;
    }
    EXPECT_EQ(some.size() == 12, spacing < std::sqrt(0.5)) << "neighbours are that far apart";
  }
  // The edge of the L-shape in two sections, one from z = 0 to 0.25, the other from there to 1: only the deeper counts.
  const TriMesh shape = test::makeLShape();
  std::vector<Vec3> points = shape.vertices;
  points.emplace_back(1, 1, 0.25);
  const std::vector<Crease> whole = creasesOf(test::wholeOf(shape));
  const auto inner = std::find_if(whole.begin(), whole.end(), [](const Crease& c) { return c.from == 3 && c.to == 9; });
  ASSERT_NE(inner, whole.end());
  for (const bool swapped : {false, true}) {
    std::vector<Crease> sections = {{3, 12, inner->left, inner->right}, {9, 12, inner->right, inner->left}};
    if (swapped) std::swap(sections[0], sections[1]);
    const auto edges = deepestConcaveEdges(sections, shape.triangles, unitNormals(shape.triangles, shape.vertices),
                                           points, convexHull(shape.vertices), 8, 0.0);
    ASSERT_EQ(edges.size(), 1u);
    EXPECT_EQ(edges[0].point, Vec3(1, 1, 0.625));
    EXPECT_NEAR(edges[0].depth, 0.375, 1e-12);
  }
}

TEST(PlanesThrough, DivideTheAngleBetweenTheFacesEvenly) {
  test::Dice dice(41);
  for (const double angle : {0.05, 0.5, 0.5 * std::numbers::pi, 2.0, 3.1}) {
    // The edge runs along z; seen from above, the empty angle is between the left face, at 0, and the right face.
    const Quat rotation = dice.rotation();
    const auto at = [&](double direction) -> Vec3 {
      return rotation * Vec3(std::cos(direction), std::sin(direction), 0.0);
    };
    ConcaveEdge edge;
    edge.point = dice.inBox(3.0);
    edge.direction = rotation * Vec3::UnitZ();
    edge.leftNormal = at(0.5 * std::numbers::pi);
    edge.rightNormal = at(angle - 0.5 * std::numbers::pi);
    for (const int count : {1, 2, 3, 5, 8}) {
      SCOPED_TRACE(testing::Message() << count << " planes, angle " << angle);
      const std::vector<Plane> planes = planesThrough(edge, count);
      ASSERT_EQ(planes.size(), static_cast<std::size_t>(count));
      for (int i = 0; i < count; ++i) {
        // The opposite half-planes, in the solid, go on where the faces end: from pi to pi + angle.
        const double share = count == 1 ? 0.5 : static_cast<double>(i) / (count - 1);
        const Vec3 expected = at(std::numbers::pi + share * angle);
        const Plane& plane = planes[i];
        EXPECT_NEAR(plane.normal.norm(), 1.0, 1e-12);
        EXPECT_NEAR(plane.normal.dot(edge.point), plane.offset, 1e-12);
        EXPECT_NEAR(plane.normal.dot(edge.direction), 0.0, 1e-12);
        EXPECT_NEAR(plane.normal.dot(expected), 0.0, 1e-11) << "plane " << i;
      }
    }
  }
  // Faces folded onto each other leave only their own plane.
  ConcaveEdge folded{Vec3(1, 2, 3), Vec3::UnitZ(), Vec3::UnitY(), -Vec3::UnitY()};
  const std::vector<Plane> planes = planesThrough(folded, 5);
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_NEAR(std::abs(planes[0].normal.y()), 1.0, 1e-12);
}

TEST(ComponentPlanes, AreHalfwayBetweenHullsThatDoNotTouch) {
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 1, 1});
  using test::joined, test::shifted;
  const auto planesOf = [](const TriMesh& mesh) { return componentPlanes(test::wholeOf(mesh), mesh.vertices); };
  EXPECT_TRUE(componentPlanes({}, {}).empty());
  const TriMesh ring = test::makeTorus(1.0, 0.2, 20, 8);
  const TriMesh other = test::moved(ring, [](const Vec3& v) { return Vec3(v.x() + 1.0, v.z(), v.y()); });
  for (const auto& [what, mesh] : {std::pair{"one box", box},
                                   {"the same box twice", joined(box, box)},
                                   {"a face in common", joined(box, shifted(box, {1, 0, 0}))},
                                   {"a corner in common", joined(box, shifted(box, {1, 1, 1}))},
                                   {"one in the other", joined(box, test::makeBox({-1, -1, -1}, {2, 2, 2}))},
                                   {"rings in one another: apart, but their hulls are not", joined(ring, other)}}) {
    EXPECT_TRUE(planesOf(mesh).empty()) << what;
  }

  test::Dice dice(42);
  for (int trial = 0; trial < 50; ++trial) {
    // Balls of radius 1 and 2, a gap apart, and a box farther away: three pairs, so three planes.
    const Quat rotation = dice.rotation();
    const double gap = dice.between(0.01, 1.0);
    const std::array<TriMesh, 3> solids = {test::makeSphere(1.0, 8, 12),
                                           shifted(test::makeSphere(2.0, 9, 14), {3.0 + gap, 0, 0}),
                                           shifted(box, {0.5, -4.0 - gap, 0.5})};
    const std::vector<Plane> planes = planesOf(
        test::moved(joined(joined(solids[0], solids[1]), solids[2]), [&](const Vec3& v) { return rotation * v; }));
    ASSERT_EQ(planes.size(), 3u);
    const auto reach = [&](const Plane& plane, std::size_t solid) {
      double low = 1e9, high = -1e9;
      for (const Vec3& v : solids[solid].vertices) {
        low = std::min(low, plane.normal.dot(rotation * v) - plane.offset);
        high = std::max(high, plane.normal.dot(rotation * v) - plane.offset);
      }
      return std::pair{low, high};
    };
    std::set<std::pair<std::size_t, std::size_t>> separated;
    for (const Plane& plane : planes) {
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) {
          if (reach(plane, a).first > 0.0 && std::abs(reach(plane, a).first + reach(plane, b).second) < 1e-12) {
            separated.insert(std::minmax(a, b));
          }
        }
      }
    }
    EXPECT_EQ(separated.size(), 3u) << "trial " << trial;
  }
}

double concavityOf(const TriMesh& mesh, double ignoreBelow = 0.0) {
  return partConcavity(convexHull(mesh.vertices), mesh.vertices, mesh.triangles, ignoreBelow);
}

TEST(PartConcavity, IsNothingForConvexParts) {
  EXPECT_NEAR(concavityOf(makeBox({0, 0, 0}, {1, 2, 3})), 0.0, 1e-4);
  EXPECT_NEAR(concavityOf(makeSphere(1.0, 16, 16)), 0.0, 5e-3);
  EXPECT_DOUBLE_EQ(concavityUnit(makeBox({0, 0, 0}, {1, 2, 3}).vertices), 1.5);
}

TEST(PartConcavity, IsTheDistanceOrTheVolumeWhicheverIsLarger) {
  // The middle of the inner edge of the L lies 1/2 below the end faces of its hull, and that of the slanted face is 1/2
  // from the L.
  EXPECT_NEAR(concavityOf(makeLShape()), 0.5, 0.005);
  // The walls of a cavity lie 1 below the surface; the cavity's volume would count for less.
  EXPECT_NEAR(concavityOf(makeHollowBox()), 1.0, 1e-3);
  EXPECT_LT(emptyConcavity(1.0), 1.0);
  EXPECT_NEAR(emptyConcavity(4.0 / 3.0 * std::numbers::pi * 8.0), 0.6, 1e-12);
}

TEST(PartConcavity, ScalesWithTheMesh) {
  const double one = concavityOf(makeTorus(1.0, 0.3, 24, 12));
  for (const double scale : {1e-3, 1e3}) {
    const TriMesh mesh = moved(makeTorus(1.0, 0.3, 24, 12), [&](const Vec3& p) { return Vec3(scale * p); });
    EXPECT_NEAR(concavityOf(mesh) / scale, one, 0.05 * one);  // sampled
  }
}

TEST(PartConcavity, StopsWhereItIsEnough) {
  const TriMesh torus = makeTorus(1.0, 0.3, 24, 12);
  const double whole = concavityOf(torus);
  const double some = partConcavity(convexHull(torus.vertices), torus.vertices, torus.triangles, 0.0, 0.1);
  EXPECT_GT(some, 0.1);
  EXPECT_LE(some, 1.01 * whole);
}

/// Two ways that share no code but the hull: of a part's own triangles, and of the intersection of mesh and hull.
TEST(PartConcavity, IsThatOfTheMeshInTheHull) {
  const TriMesh torus = makeTorus(1.0, 0.3, 48, 24);
  DecomposeSettings settings;
  settings.maxParts = 8;
  const Decomposition made = valueOf(decompose(torus, {torus.vertices, countOf(torus.vertices)}, settings));
  std::vector<Vec3> points(made.pointCount());
  transfer(made, torus.vertices, points);
  const TriangleTree tree(torus.vertices, torus.triangles);
  for (const Part& part : made.parts) {
    std::vector<Vec3> own;
    for (const PointIndex p : part.points) own.push_back(points[p]);
    const ConvexHull hull = convexHull(own);
    EXPECT_NEAR(hullConcavity(torus, tree, hull, 4000, 1), partConcavity(hull, points, part.triangles, 0.0), 0.02);
  }
}

TEST(DecomposeToConcavity, MeetsTheLimitWithFewParts) {
  // Of no volume, and so is their common hull, which spans what is between them.
  const TriMesh grain = makeBox({12, 0, 0}, {12.0005, 0.0005, 0.0005});
  const TriMesh grains = joined(joined(makeBox({0, 0, 0}, {10, 10, 10}), grain), shifted(grain, {0, 2, 0}));
  struct Row {
    TriMesh mesh;
    double limit;
    std::size_t parts;  // expected at most
  };
  for (const Row& row :
       {Row{makeBox({0, 0, 0}, {1, 1, 1}), 0.05, 1}, Row{makeLShape(), 0.05, 2},
        Row{makeTorus(1.0, 0.3, 24, 12), 0.13, 10}, Row{makeTorus(1.0, 0.3, 24, 12), 2.0, 1}, Row{grains, 0.5, 3}}) {
    DecomposeSettings settings;
    settings.maxParts = 0;
    settings.maxConcavity = row.limit;
    const PoseView pose{row.mesh.vertices, countOf(row.mesh.vertices)};
    const Decomposition made = valueOf(decompose(row.mesh, pose, settings));
    EXPECT_LE(made.parts.size(), row.parts);
    std::vector<Vec3> points(made.pointCount());
    transfer(made, row.mesh.vertices, points);
    for (const Part& part : made.parts) {
      std::vector<Vec3> own;
      for (const PointIndex p : part.points) own.push_back(points[p]);
      EXPECT_LE(partConcavity(convexHull(own), points, part.triangles, row.limit), row.limit * (1.0 + 1e-9));
    }
    settings.threads = 1;
    EXPECT_EQ(hashOf(made), hashOf(valueOf(decompose(row.mesh, pose, settings))));
  }
}

}  // namespace
}  // namespace lorica::test
