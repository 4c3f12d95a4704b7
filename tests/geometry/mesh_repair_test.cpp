#include "geometry/mesh_repair.h"

#include "geometry/mesh_files.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"
#include "tests/support/voxels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace lorica {
namespace {

MeshRepair repaired(const TriMesh& mesh) {
  return test::valueOf(repairClosedMesh(mesh));
}

/// Counts edges shared by more than two triangles, independently of the code under test.
std::size_t nonManifoldEdges(const TriMesh& mesh) {
  std::map<std::pair<VertexIndex, VertexIndex>, int> sides;
  for (const Triangle& t : mesh.triangles) {
    for (int e = 0; e < 3; ++e) ++sides[std::minmax(t[e], t[(e + 1) % 3])];
  }
  return static_cast<std::size_t>(
      std::count_if(sides.begin(), sides.end(), [](const auto& side) { return side.second > 2; }));
}

/// Checks: two-manifold, same volume and area, input vertices kept, added vertices at the positions that they refer to.
void expectSound(const TriMesh& mesh, const MeshRepair& repair) {
  const Result<void> checked = checkClosedTwoManifold(repair.mesh);
  EXPECT_TRUE(checked.ok()) << (checked.ok() ? "" : checked.error().message);
  const double volume = signedVolume(mesh.vertices, mesh.triangles);
  EXPECT_NEAR(signedVolume(repair.mesh.vertices, repair.mesh.triangles), volume, 1e-12 * std::abs(volume));
  ASSERT_EQ(repair.origin.size(), repair.mesh.vertices.size());
  ASSERT_EQ(repair.sourceTriangle.size(), repair.mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_EQ(repair.mesh.vertices[v], mesh.vertices[v]);
    EXPECT_EQ(repair.origin[v], (VertexOrigin{static_cast<VertexIndex>(v), static_cast<VertexIndex>(v)}));
  }
  EXPECT_EQ(repair.mesh.vertices.size() - mesh.vertices.size(), repair.doubledVertices + repair.halvedEdges);
  EXPECT_EQ(repair.carried(mesh.vertices), repair.mesh.vertices);
  // Every corner maps to a corner, or to the midpoint of an edge, of its source triangle.
  for (std::size_t t = 0; t < repair.mesh.triangles.size(); ++t) {
    const Triangle& source = mesh.triangles[repair.sourceTriangle[t]];
    for (const VertexIndex v : repair.mesh.triangles[t]) {
      const auto& [first, second] = repair.origin[v];
      EXPECT_NE(std::find(source.begin(), source.end(), first), source.end());
      EXPECT_NE(std::find(source.begin(), source.end(), second), source.end());
    }
  }
}

TEST(MeshRepair, AManifoldComesBackAsItWas) {
  for (const TriMesh& mesh : {test::makeTetrahedron(), test::makeTorus(1, 0.3, 8, 6),
                              test::joined(test::makeLShape(), test::makeBox({5, 5, 5}, {6, 6, 6}))}) {
    const MeshRepair repair = repaired(mesh);
    EXPECT_FALSE(repair.changed());
    EXPECT_EQ(repair.summary(), "");
    EXPECT_EQ(repair.mesh.triangles, mesh.triangles);
    EXPECT_EQ(repair.mesh.vertices, mesh.vertices);
  }
}

TEST(MeshRepair, CubesThatTouchInAnEdgeComeApart) {
  const TriMesh mesh = test::makeVoxelSurface({{0, 0, 0}, {1, 1, 0}});
  EXPECT_FALSE(checkClosedTwoManifold(mesh).ok());
  const MeshRepair repair = repaired(mesh);
  expectSound(mesh, repair);
  EXPECT_EQ(repair.nonManifoldEdges, 1u);
  EXPECT_EQ(repair.doubledVertices, 2u);
  EXPECT_EQ(repair.halvedEdges, 0u);
  EXPECT_EQ(repair.summary(), "1 non-manifold edge separated, 2 vertices duplicated");
  // If the wedges of air had been paired, there would be one component.
  const Components components = connectedComponents(repair.mesh.vertices.size(), repair.mesh.triangles);
  ASSERT_EQ(components.count, 2);
  for (std::int32_t c = 0; c < 2; ++c) {
    std::vector<Triangle> own;
    for (std::size_t t = 0; t < repair.mesh.triangles.size(); ++t) {
      if (components.componentOfTriangle[t] == c) own.push_back(repair.mesh.triangles[t]);
    }
    EXPECT_DOUBLE_EQ(signedVolume(repair.mesh.vertices, own), 1.0);
  }
}

TEST(MeshRepair, CubesRoundOneEdgeInAFanComeApart) {
  // Three wedges of a hexagonal prism that share its axis: six triangles at one edge.
  TriMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < 6; ++i) {
    const double angle = i * M_PI / 3.0;
    mesh.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    mesh.vertices.emplace_back(std::cos(angle), std::sin(angle), 1);
  }
  for (int i = 0; i < 6; i += 2) {
    const VertexIndex a = 2 + 2 * i, b = 4 + 2 * i;  // lower ends; the upper end is the next index
    for (const Triangle& t : std::initializer_list<Triangle>{{0, b, a},
                                                             {1, a + 1, b + 1},
                                                             {0, a, 1},
                                                             {a, a + 1, 1},
                                                             {a, b, a + 1},
                                                             {b, b + 1, a + 1},
                                                             {b, 0, b + 1},
                                                             {0, 1, b + 1}}) {
      mesh.triangles.push_back(t);
    }
  }
  const MeshRepair repair = repaired(mesh);
  expectSound(mesh, repair);
  EXPECT_EQ(repair.doubledVertices, 4u);
  EXPECT_EQ(connectedComponents(repair.mesh.vertices.size(), repair.mesh.triangles).count, 3);
}

TEST(MeshRepair, AnEdgeJoinedAtBothEndsIsHalved) {
  // Two diagonal cubes of a layer between two full ones: the solid is joined above and below the edge.
  std::set<test::Voxel> voxels;
  for (int i = 0; i < 12; ++i) {
    const int x = i % 2, y = i / 2 % 2, z = i / 4;
    if (z != 1 || x == y) voxels.insert({x, y, z});
  }
  const TriMesh mesh = test::makeVoxelSurface(voxels);
  ASSERT_EQ(nonManifoldEdges(mesh), 1u);
  const MeshRepair repair = repaired(mesh);
  expectSound(mesh, repair);
  EXPECT_EQ(repair.halvedEdges, 1u);
  EXPECT_EQ(repair.doubledVertices, 0u);
  EXPECT_EQ(repair.summary(), "1 non-manifold edge separated, 1 edge split at the midpoint");
  EXPECT_EQ(repair.mesh.vertices.back(), Vec3(1, 1, 1.5));
  // In another pose the midpoint stays at the midpoint.
  std::vector<Vec3> posed = mesh.vertices;
  for (Vec3& v : posed) v = Vec3(v.x() + v.z() * v.z(), 2 * v.y(), v.z() - 3);
  EXPECT_EQ(repair.carried(posed).back(), Vec3(1 + 2.5, 2, -1.5));
}

TEST(MeshRepair, TrianglesThatAddNothingAreDropped) {
  TriMesh mesh = test::makeBox({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back({3, 3, 5});
  mesh.triangles.push_back(mesh.triangles[4]);  // turns edges of two triangles into edges of three
  std::rotate(mesh.triangles.back().begin(), mesh.triangles.back().begin() + 1, mesh.triangles.back().end());
  mesh.triangles.push_back({0, 3, 7});
  mesh.triangles.push_back({0, 7, 3});  // a wall across the inside, both of its sides
  ASSERT_FALSE(checkClosedTwoManifold(mesh).ok());
  const MeshRepair repair = repaired(mesh);
  expectSound(mesh, repair);
  EXPECT_EQ(repair.mesh.triangles.size(), 12u);
  EXPECT_EQ(
      repair.summary(),
      "2 back-to-back triangles removed, 1 duplicate triangle removed, 1 triangle with a repeated corner removed");
}

TEST(MeshRepair, TheWallBetweenStackedBoxesGoes) {
  TriMesh mesh = test::joined(test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({1, 0, 0}, {2, 1, 1}));
  ASSERT_EQ(weldEqualVertices(mesh), 4u);
  ASSERT_FALSE(checkClosedTwoManifold(mesh).ok());
  const MeshRepair repair = repaired(mesh);
  expectSound(mesh, repair);
  EXPECT_EQ(repair.summary(), "4 back-to-back triangles removed");
  EXPECT_EQ(connectedComponents(repair.mesh.vertices.size(), repair.mesh.triangles).count, 1);
}

TEST(MeshRepair, WhatIsNotClosedIsRefusedInTheWordsOfTheCheck) {
  TriMesh open = test::makeVoxelSurface({{0, 0, 0}, {1, 1, 0}});
  open.triangles.pop_back();
  TriMesh outside = test::makeTetrahedron();
  outside.triangles[2][1] = 4;
  TriMesh turned = test::makeTetrahedron();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  TriMesh infinite = test::makeTetrahedron();
  infinite.vertices[1].y() = std::numeric_limits<double>::infinity();
  for (const TriMesh& mesh : {open, outside, turned, infinite, TriMesh()}) {
    const Result<MeshRepair> repair = repairClosedMesh(mesh);
    ASSERT_FALSE(repair.ok());
    EXPECT_EQ(repair.error().message, checkClosedTwoManifold(mesh).error().message);
  }
}

TEST(MeshRepair, TheCheckNamesTheRepairOnlyWhereItHelps) {
  const auto sentence = [](const TriMesh& mesh) { return checkClosedTwoManifold(mesh).error().message; };
  TriMesh mesh = test::makeVoxelSurface({{0, 0, 0}, {1, 1, 0}});
  EXPECT_NE(sentence(mesh).find("repairClosedMesh() can separate the triangles"), std::string::npos) << sentence(mesh);
  mesh.triangles.push_back(mesh.triangles[0]);
  mesh.triangles.push_back(mesh.triangles[0]);
  EXPECT_EQ(sentence(mesh).find("repairClosedMesh"), std::string::npos) << sentence(mesh);
}

TEST(MeshRepair, RandomHeapsOfCubes) {
  std::mt19937_64 random(20180601);
  std::size_t halved = 0, doubled = 0;
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    std::set<test::Voxel> voxels;
    const int size = 2 + static_cast<int>(random() % 3);
    const std::uint64_t share = 2 + random() % 6;
    for (int i = 0; i < size * size * size; ++i) {
      if (random() % 8 < share) voxels.insert({i / size / size, i / size % size, i % size});
    }
    if (voxels.empty()) continue;
    const TriMesh mesh = test::makeVoxelSurface(voxels);
    ASSERT_DOUBLE_EQ(signedVolume(mesh.vertices, mesh.triangles), static_cast<double>(voxels.size()));
    const MeshRepair repair = repaired(mesh);
    expectSound(mesh, repair);
    EXPECT_EQ(repair.nonManifoldEdges, nonManifoldEdges(mesh));
    halved += repair.halvedEdges;
    doubled += repair.doubledVertices;
    // A second repair finds nothing to do.
    EXPECT_FALSE(repaired(repair.mesh).changed());
  }
  EXPECT_GT(halved, 20u);
  EXPECT_GT(doubled, 500u);
}

TEST(MeshRepair, TheDinosaurOfTheBenchmark) {
  LORICA_REQUIRE_DATASET(file, "vhacd/Dinosaur.off");
  const TriMesh mesh = test::valueOf(readMesh(file));
  EXPECT_FALSE(checkClosedTwoManifold(mesh).ok());
  const MeshRepair repair = repaired(mesh);
  expectSound(mesh, repair);
  EXPECT_EQ(repair.nonManifoldEdges, 2u);
}

}  // namespace
}  // namespace lorica
