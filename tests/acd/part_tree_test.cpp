#include "acd/part_tree.h"

#include "acd/level_of_detail.h"
#include "tests/acd/hard_meshes.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace lorica {
namespace {

constexpr double kTolerance = 1e-9;

/// A torus in two keyframes, different in all directions, and its tree for planes in one of them.
struct TorusTree : ::testing::Test {
  TorusTree() : mesh(test::makeTorus(1.0, 0.4, 40, 18)), part(test::wholeOf(mesh)), keyframes(2, mesh.vertices) {
    for (Vec3& v : keyframes[1]) v = Vec3(2.0 * v.z(), v.x() + 0.5 * v.z() * v.z(), 3.0 - v.y());
  }
  [[nodiscard]] PartTree treeFor(std::size_t keyframe) const { return {part, keyframes, keyframe}; }

  /// The mesh vertex of every point of a tree, found by its positions in all keyframes.
  [[nodiscard]] std::vector<PointIndex> verticesOf(const PartTree& tree) const {
    using Position = std::array<double, 6>;
    const auto key = [](const Vec3& a, const Vec3& b) { return Position{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}; };
    std::map<Position, PointIndex> vertexAt;
    for (const PointIndex p : part.points) vertexAt[key(keyframes[0][p], keyframes[1][p])] = p;
    std::vector<PointIndex> vertices;
    for (std::size_t i = 0; i < tree.points(0).size(); ++i) {
      const auto found = vertexAt.find(key(tree.points(0)[i], tree.points(1)[i]));
      EXPECT_NE(found, vertexAt.end()) << "point " << i;
      vertices.push_back(found == vertexAt.end() ? -1 : found->second);
    }
    return vertices;
  }

  TriMesh mesh;
  Part part;
  std::vector<std::vector<Vec3>> keyframes;
};

TEST(PartTree, APartOfFewTrianglesIsOneLeaf) {
  const TriMesh mesh = test::makeTetrahedron();
  const std::vector<std::vector<Vec3>> keyframes = {mesh.vertices};
  PartTree::Sketch sketch;
  const PartTree nothing(Part{}, keyframes, 0);
  EXPECT_EQ(nothing.nodes().size(), 1u);
  EXPECT_TRUE(nothing.points(0).empty());
  EXPECT_FALSE(nothing.sketch({Vec3::UnitX(), 0.5}, kTolerance, sketch));

  const PartTree tree(test::wholeOf(mesh), keyframes, 0);
  ASSERT_EQ(tree.nodes().size(), 1u);
  EXPECT_EQ(tree.keyframeCount(), 1u);
  EXPECT_LT(tree.nodes()[0].second, 0);
  EXPECT_EQ(tree.nodes()[0].first, 0);
  EXPECT_EQ(tree.nodes()[0].last, 4);
  EXPECT_EQ(tree.nodes()[0].box.min, Vec3(0, 0, 0));
  EXPECT_EQ(tree.nodes()[0].box.max, Vec3(1, 1, 1));
  EXPECT_EQ(tree.points(0).size(), 4u);
  EXPECT_EQ(tree.pointsOf(0).size(), 4u);
}

TEST(PartTree, APlaneThatOnlyTouchesThePartDoesNotDivideIt) {
  const TriMesh mesh = test::makeTetrahedron();
  const std::vector<std::vector<Vec3>> keyframes = {mesh.vertices};
  const PartTree tree(test::wholeOf(mesh), keyframes, 0);
  PartTree::Sketch sketch;
  // Beside it, along a side, along the slanted side, through an edge, through a corner, and just inside that corner.
  const Vec3 slanted = Vec3(1, 1, 1).normalized();
  for (const Plane& plane : {Plane{Vec3::UnitX(), -1.0}, Plane{Vec3::UnitX(), 0.0}, Plane{slanted, slanted.x()},
                             Plane{Vec3(1, 1, 0).normalized(), 0.0}, Plane{Vec3::UnitX(), 1.0},
                             Plane{Vec3::UnitX(), 1.0 - 0.5 * kTolerance}}) {
    EXPECT_FALSE(tree.sketch(plane, kTolerance, sketch)) << plane.normal.transpose() << ", " << plane.offset;
    EXPECT_FALSE(tree.sketch({-plane.normal, -plane.offset}, kTolerance, sketch));
  }
  EXPECT_TRUE(tree.sketch({Vec3::UnitX(), 1.0 - 2.0 * kTolerance}, kTolerance, sketch));
  EXPECT_EQ(sketch.crossings.size(), 3u);

  // A block whose top has many triangles: some leaves contain nothing else, and all of their points are on the plane.
  std::set<test::Voxel> voxels;
  for (int i = 0; i < 64; ++i) voxels.insert({i % 8, i / 8, 0});
  TriMesh block = test::makeVoxelSurface(voxels);
  for (Vec3& v : block.vertices) v.z() *= 20.0;
  const std::vector<std::vector<Vec3>> blockKeyframes = {block.vertices};
  const PartTree leaves(test::wholeOf(block), blockKeyframes, 0);
  EXPECT_GT(leaves.nodes().size(), 7u);
  for (const double below : {0.0, 0.5 * kTolerance}) {
    EXPECT_FALSE(leaves.sketch({Vec3::UnitZ(), 20.0 - below}, kTolerance, sketch));
    EXPECT_TRUE(sketch.above.nodes.empty());
    EXPECT_TRUE(sketch.above.points.empty());
  }
  EXPECT_TRUE(leaves.sketch({Vec3::UnitZ(), 10.0}, kTolerance, sketch));
}

TEST_F(TorusTree, ChildrenDivideTheTrianglesOfTheirParent) {
  for (const std::size_t keyframe : {0u, 1u}) {
    const PartTree tree = treeFor(keyframe);
    const std::span<const PartTree::Node> nodes = tree.nodes();
    EXPECT_EQ(nodes[0].first, 0);
    EXPECT_EQ(nodes[0].last, countOf(mesh.triangles));
    EXPECT_GT(nodes.size(), 16u);
    std::int32_t fresh = 0;
    std::set<int> reached = {0};
    for (int n = 0; n < countOf(nodes); ++n) {
      const PartTree::Node& node = nodes[n];
      Aabb box;
      for (const std::int32_t p : tree.pointsOf(n)) box.extend(tree.points(keyframe)[p]);
      EXPECT_EQ(node.box.min, box.min) << "node " << n;
      EXPECT_EQ(node.box.max, box.max) << "node " << n;
      EXPECT_LT(node.first, node.last);
      if (node.second >= 0) {
        ASSERT_LT(node.second, countOf(nodes));
        EXPECT_EQ(nodes[n + 1].first, node.first);
        EXPECT_EQ(nodes[n + 1].last, nodes[node.second].first);
        EXPECT_EQ(nodes[node.second].last, node.last);
        EXPECT_TRUE(reached.insert(n + 1).second);
        EXPECT_TRUE(reached.insert(node.second).second);
        continue;
      }
      // Points are numbered in the order in which leaves first use them.
      std::set<std::int32_t> own;
      for (const std::int32_t p : tree.pointsOf(n)) {
        EXPECT_TRUE(own.insert(p).second) << "a leaf lists a point once";
        EXPECT_LE(p, fresh);
        fresh = std::max(fresh, p + 1);
      }
    }
    EXPECT_EQ(reached.size(), nodes.size());
    EXPECT_EQ(static_cast<std::size_t>(fresh), part.points.size());
    std::vector<PointIndex> vertices = verticesOf(tree);
    std::sort(vertices.begin(), vertices.end());
    EXPECT_EQ(vertices, part.points);
  }
}

TEST_F(TorusTree, ASketchFindsThePointsOfTheActualCut) {
  test::Dice dice(21);
  PartTree::Sketch sketch;  // reused: nothing of an earlier plane may remain
  for (const std::size_t keyframe : {0u, 1u}) {
    const PartTree tree = treeFor(keyframe);
    const std::vector<PointIndex> vertexOf = verticesOf(tree);
    const auto firstNew = countOf(mesh.vertices);
    for (const Plane& plane : test::planesThrough(keyframes[keyframe], dice, 40)) {
      SCOPED_TRACE(testing::Message() << "normal " << plane.normal.transpose() << ", offset " << plane.offset);
      const CutResult cut = cutPart(part, keyframes[keyframe], plane, kTolerance, firstNew);
      EXPECT_EQ(tree.sketch(plane, kTolerance, sketch), !cut.above.triangles.empty() && !cut.below.triangles.empty());

      for (const auto& [half, truth] : {std::pair{&sketch.above, &cut.above}, std::pair{&sketch.below, &cut.below}}) {
        std::set<PointIndex> found;
        for (const std::int32_t node : half->nodes) {
          for (const std::int32_t p : tree.pointsOf(node)) found.insert(vertexOf[p]);
        }
        for (const std::int32_t p : half->points) found.insert(vertexOf[p]);
        std::set<PointIndex> expected(truth->points.begin(), truth->points.end());
        expected.erase(expected.lower_bound(firstNew), expected.end());
        EXPECT_EQ(found, expected);
      }

      // The same edges are crossed at the same place; a point number in the tree may reverse an edge.
      std::map<std::pair<PointIndex, PointIndex>, double> lambdas;
      for (const CutPoint& c : cut.newPoints) lambdas.insert({{c.first, c.second}, c.lambda});
      ASSERT_EQ(sketch.crossings.size(), lambdas.size());
      for (const CutPoint& c : sketch.crossings) {
        const PointIndex a = vertexOf[c.first], b = vertexOf[c.second];
        const auto truth = lambdas.find(std::minmax(a, b));
        ASSERT_NE(truth, lambdas.end()) << a << "-" << b;
        EXPECT_NEAR(a < b ? c.lambda : 1.0 - c.lambda, truth->second, 1e-12);
      }
    }
  }
}

TEST_F(TorusTree, EveryEntryOfASketchBelongsToItsLeaf) {
  test::Dice dice(22);
  const PartTree tree = treeFor(1);
  PartTree::Sketch sketch;
  for (const Plane& plane : test::planesThrough(keyframes[1], dice, 40)) {
    ASSERT_TRUE(tree.sketch(plane, kTolerance, sketch) || sketch.crossings.empty());
    std::size_t above = 0, below = 0, crossing = 0;
    std::set<std::int32_t> onceOnly;
    for (const PartTree::CutLeaf& leaf : sketch.leaves) {
      EXPECT_LT(tree.nodes()[leaf.node].second, 0);
      EXPECT_TRUE(onceOnly.insert(leaf.node).second);
      const std::span<const std::int32_t> points = tree.pointsOf(leaf.node);
      const std::set<std::int32_t> own(points.begin(), points.end());
      ASSERT_LE(leaf.endAbove, sketch.above.points.size());
      ASSERT_LE(leaf.endBelow, sketch.below.points.size());
      ASSERT_LE(leaf.endCrossings, sketch.crossings.size());
      for (; above < leaf.endAbove; ++above) EXPECT_TRUE(own.contains(sketch.above.points[above]));
      for (; below < leaf.endBelow; ++below) EXPECT_TRUE(own.contains(sketch.below.points[below]));
      for (; crossing < leaf.endCrossings; ++crossing) {
        for (const int p : {sketch.crossings[crossing].first, sketch.crossings[crossing].second}) {
          EXPECT_TRUE(own.contains(p));
        }
      }
    }
    EXPECT_EQ(above, sketch.above.points.size());
    EXPECT_EQ(below, sketch.below.points.size());
    EXPECT_EQ(crossing, sketch.crossings.size());
    // No point is listed twice on one side.
    for (const auto* list : {&sketch.above.points, &sketch.below.points}) {
      EXPECT_EQ(std::set<std::int32_t>(list->begin(), list->end()).size(), list->size());
    }
    for (const std::int32_t node : sketch.above.nodes) EXPECT_TRUE(onceOnly.insert(node).second);
    for (const std::int32_t node : sketch.below.nodes) EXPECT_TRUE(onceOnly.insert(node).second);
  }
}

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
