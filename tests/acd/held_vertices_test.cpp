#include "acd/held_vertices.h"

#include "acd/decomposition_file.h"
#include "tests/acd/parts.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <random>

namespace lorica::test {
namespace {

/// An L of two boxes, with vertices around it that no triangle uses.
struct Fixture {
  TriMesh mesh = makeLShape();
  std::vector<VertexIndex> held;
  Decomposition parts;

  explicit Fixture(std::span<const Vec3> loose) {
    for (const Vec3& p : loose) {
      held.push_back(countOf(mesh.vertices));
      mesh.vertices.push_back(p);
    }
    parts = decomposed(mesh, {});
  }
};

TEST(HeldVertices, WhatIsInsideIsNotAssigned) {
  const Fixture f(std::vector<Vec3>{{0.5, 0.5, 0.5}, {0, 0, 0}, {1.5, 0.5, 1.0}});
  for (const auto& own : assignHeldVertices(f.parts, f.mesh.vertices, f.held)) EXPECT_TRUE(own.empty());
}

TEST(HeldVertices, EachGoesToThePartWithTheNearestHull) {
  const Fixture f(std::vector<Vec3>{{3.0, 0.5, 0.5}, {0.5, 2.5, 0.5}, {0.5, 0.5, 0.5}});
  ASSERT_EQ(f.parts.parts.size(), 2u);
  const auto assigned = assignHeldVertices(f.parts, f.mesh.vertices, f.held);
  const std::vector<ConvexHull> hulls = partHulls(f.parts, transferred(f.parts, f.mesh.vertices));
  std::size_t count = 0;
  for (std::size_t i = 0; i < assigned.size(); ++i) {
    for (const PointIndex p : assigned[i]) {
      ++count;
      const double own = largestViolation(hulls[i], {&f.mesh.vertices[p], 1});
      EXPECT_LE(own, largestViolation(hulls[1 - i], {&f.mesh.vertices[p], 1}));
    }
  }
  EXPECT_EQ(count, 2u);
}

TEST(HeldVertices, HullsContainThemAndGrowByAPyramid) {
  // A unit above the middle of a side of a cube: a pyramid of volume 1/3.
  TriMesh mesh = makeBox({0, 0, 0}, {1, 1, 1});
  mesh.vertices.emplace_back(0.5, 2.0, 0.5);
  const Decomposition parts = decomposed(mesh, {});
  const std::vector<VertexIndex> held = {8};
  const Decomposition with = withHeldVertices(parts, assignHeldVertices(parts, mesh.vertices, held));
  EXPECT_NEAR(errorInPose(with, mesh, mesh.vertices).relative(), 1.0 / 3.0, 1e-12);
  EXPECT_EQ(with.parts[0].triangles, parts.parts[0].triangles);
}

TEST(HeldVertices, ACoverBringsThemThroughAFile) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(-1.0, 3.0);
  std::vector<Vec3> loose;
  for (int i = 0; i < 50; ++i) loose.emplace_back(at(random), at(random), at(random));
  const Fixture f(loose);
  const Decomposition with = withHeldVertices(f.parts, assignHeldVertices(f.parts, f.mesh.vertices, f.held));
  DecompositionFile content;
  content.decomposition = f.parts;
  content.source = "l.obj";
  content.meshHash = topologyHash(f.mesh);
  content.cover = coverWithHeldVertices(with);
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "l.lorica";
  const Result<void> written = writeDecomposition(file, content);
  ASSERT_TRUE(written) << written.error().message;
  const DecompositionFile read = readDecomposition(file).value();
  ASSERT_TRUE(read.cover);
  const std::vector<Vec3> points = transferred(with, f.mesh.vertices);
  for (std::size_t i = 0; i < with.parts.size(); ++i) {
    std::vector<Vec3> own;
    for (const CoverPoint& p : read.cover->points[i]) own.push_back(points[p.point]);
    EXPECT_NEAR(convexHullVolume(own), partHull(with.parts[i], points).volume, 1e-9);
  }
}

}  // namespace
}  // namespace lorica::test
