#include "acd/half_volumes.h"

#include "geometry/convex_hull.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

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

}  // namespace
}  // namespace lorica
