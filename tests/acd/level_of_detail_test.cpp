#include "acd/level_of_detail.h"

#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica {
namespace {

/// A torus in two poses: unchanged, and bent and stretched.
struct Animated {
  TriMesh mesh = test::makeTorus(1.0, 0.3, 24, 12);
  std::vector<Vec3> positions = mesh.vertices;

  Animated() {
    for (const Vec3& p : mesh.vertices) positions.emplace_back(1.4 * p.x(), p.y() + 0.3 * p.x() * p.x(), 0.8 * p.z());
  }
  [[nodiscard]] PoseView keyframes() const { return {positions, countOf(mesh.vertices)}; }
};

Decomposition decomposed(const Animated& animated, DecomposePreset preset) {
  return test::decomposed(animated.mesh, animated.keyframes(), {.maxParts = 9, .preset = preset});
}

class LevelOfDetail : public testing::TestWithParam<DecomposePreset> {};
INSTANTIATE_TEST_SUITE_P(Presets, LevelOfDetail,
                         testing::Values(DecomposePreset::kPaper, DecomposePreset::kFast, DecomposePreset::kQuality));

TEST_P(LevelOfDetail, EveryLevelIsADecompositionOfTheMesh) {
  const Animated animated;
  const Decomposition all = decomposed(animated, GetParam());
  for (int n = 1; n <= countOf(all.parts); ++n) {
    const Decomposition level = levelOfDetail(all, n);
    ASSERT_EQ(level.parts.size(), static_cast<std::size_t>(n));
    ASSERT_EQ(level.splitFrom.size(), level.parts.size() - 1);
    EXPECT_EQ(level.pointCount(), all.pointCount());
    std::vector<bool> covered(all.triangleCount, false);
    for (int k = 0; k < 2; ++k) {
      const std::vector<Vec3> points = test::transferred(level, animated.keyframes().keyframe(k));
      const double meshVolume = signedVolume(animated.keyframes().keyframe(k), animated.mesh.triangles);
      double volume = 0.0;
      for (const Part& part : level.parts) {
        volume += signedVolume(points, part.triangles);
        ASSERT_EQ(part.triangles.size(), part.sourceTriangle.size());
        for (const std::int32_t source : part.sourceTriangle) {
          if (source >= 0) covered[source] = true;
        }
      }
      EXPECT_NEAR(volume, meshVolume, 1e-9 * meshVolume) << n << " parts, keyframe " << k;
    }
    EXPECT_EQ(std::count(covered.begin(), covered.end(), false), 0);
  }
}

TEST_P(LevelOfDetail, DetailLevelsSaysWhatTheJoinedPartsMeasure) {
  const Animated animated;
  const Decomposition all = decomposed(animated, GetParam());
  const std::vector<DetailLevel> levels =
      detailLevels(all, animated.mesh, animated.keyframes(), hullsOfParts(all, animated.keyframes()));
  ASSERT_EQ(levels.size(), all.parts.size());
  for (int n = 1; n <= countOf(all.parts); ++n) {
    // Slow reference: merge the triangles, then compute the hulls of all their points.
    const Decomposition level = levelOfDetail(all, n);
    double errors[2];
    int hullVertices[2] = {0, 0};
    for (int k = 0; k < 2; ++k) {
      errors[k] = errorInPose(level, animated.mesh, animated.keyframes().keyframe(k)).relative();
      const std::vector<Vec3> points = test::transferred(level, animated.keyframes().keyframe(k));
      for (const ConvexHull& hull : partHulls(level, points)) hullVertices[k] += std::ssize(hull.vertices);
    }
    const DetailLevel& judged = levels[static_cast<std::size_t>(n) - 1];
    EXPECT_NEAR(judged.meanError, 0.5 * (errors[0] + errors[1]), 1e-8) << n;
    EXPECT_NEAR(judged.worstError, std::max(errors[0], errors[1]), 1e-8) << n;
    // Rounding decides whether points in a face or on an edge, such as those of former cuts, are vertices.
    // detailLevels() goes from hull to hull and loses some of them.
    const int max = std::max(hullVertices[0], hullVertices[1]);
    EXPECT_LE(judged.hullVertices, 1.02 * max) << n;
    EXPECT_GE(judged.hullVertices, 0.75 * max) << n;
  }
  EXPECT_GT(levels.front().meanError, 2.0 * levels.back().meanError);
}

TEST(LevelOfDetail, OnePartOfAPaperCutIsTheMeshAgain) {
  // After a single cut both halves share the same cap triangles: without them the L-shape is restored.
  const TriMesh mesh = test::makeLShape();
  const Decomposition one =
      levelOfDetail(test::decomposed(mesh, {.maxParts = 2, .preset = DecomposePreset::kPaper}), 1);
  ASSERT_EQ(one.parts.size(), 1u);
  EXPECT_TRUE(one.splitFrom.empty());
  EXPECT_EQ(std::count(one.parts[0].sourceTriangle.begin(), one.parts[0].sourceTriangle.end(), -1), 0);
  const TriMesh whole{test::transferred(one, mesh.vertices), one.parts[0].triangles};
  const auto closed = checkClosedTwoManifold(whole);
  EXPECT_TRUE(closed.ok()) << (closed.ok() ? "" : closed.error().message);
  EXPECT_NEAR(surfaceArea(whole.vertices, whole.triangles), surfaceArea(mesh.vertices, mesh.triangles), 1e-12);
}

TEST(LevelOfDetail, AllPartsAreTheDecompositionItself) {
  const Animated animated;
  const Decomposition all = decomposed(animated, DecomposePreset::kFast);
  EXPECT_EQ(hashOf(levelOfDetail(all, countOf(all.parts))), hashOf(all));
}

TEST(DetailLevels, OfTheLShapeHasItsClosedForm) {
  const TriMesh mesh = test::makeLShape();
  const PoseView pose = test::poseOf(mesh);
  const Decomposition both = test::decomposed(mesh, {.maxParts = 2});
  const std::vector<DetailLevel> levels = detailLevels(both, mesh, pose, hullsOfParts(both, pose));
  ASSERT_EQ(levels.size(), 2u);
  // One hull: an extruded pentagon of volume 3.5 for a mesh of 3. Two hulls: boxes.
  EXPECT_NEAR(levels[0].meanError, 0.5 / 3.0, 1e-12);
  EXPECT_NEAR(levels[0].worstError, 0.5 / 3.0, 1e-12);
  EXPECT_EQ(levels[0].hullVertices, 10);
  EXPECT_NEAR(levels[1].meanError, 0.0, 1e-12);
  EXPECT_EQ(levels[1].hullVertices, 16);
}

}  // namespace
}  // namespace lorica
