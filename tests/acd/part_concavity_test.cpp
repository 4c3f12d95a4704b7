#include "acd/part_concavity.h"

#include "acd/decompose.h"
#include "acd/hull_concavity.h"
#include "acd/transfer.h"
#include "geometry/counts.h"
#include "geometry/triangle_tree.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace lorica::test {
namespace {

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
