#include "geometry/mesh_repair.h"

#include "geometry/mesh_files.h"
#include "geometry/shell_union.h"
#include "geometry/triangle_tree.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace lorica::test {
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
    EXPECT_EQ(errorOf(repairClosedMesh(mesh)).message, checkClosedTwoManifold(mesh).error().message);
  }
}

TEST(MeshRepair, TheCheckNamesTheRepairOnlyWhereItHelps) {
  const auto sentence = [](const TriMesh& mesh) { return checkClosedTwoManifold(mesh).error().message; };
  TriMesh mesh = test::makeVoxelSurface({{0, 0, 0}, {1, 1, 0}});
  EXPECT_TRUE(has(sentence(mesh), "repairClosedMesh() can separate the triangles"));
  mesh.triangles.push_back(mesh.triangles[0]);
  mesh.triangles.push_back(mesh.triangles[0]);
  EXPECT_FALSE(has(sentence(mesh), "repairClosedMesh"));
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

double volumeOf(const TriMesh& mesh) {
  return signedVolume(mesh.vertices, mesh.triangles);
}

TriMesh together(const std::vector<TriMesh>& solids) {
  TriMesh all;
  for (const TriMesh& solid : solids) all = joined(all, solid);
  return all;
}

/// The union, checked as far as every union must be sound.
ShellUnion united(const TriMesh& mesh) {
  const std::optional<ShellUnion> made = valueOf(uniteShells(mesh));
  EXPECT_TRUE(made.has_value());
  if (!made) return {mesh, 0};
  EXPECT_TRUE(checkClosedTwoManifold(made->mesh));
  EXPECT_TRUE(std::equal(mesh.vertices.begin(), mesh.vertices.end(), made->mesh.vertices.begin()));
  return *made;
}

TEST(ShellUnion, VolumeOfBoxesCountsOnce) {
  const TriMesh base = makeBox({0, 0, 0}, {3, 1, 1});
  const TriMesh left = makeBox({0, 0, 0}, {1, 3, 1}), right = makeBox({2, 0, 0}, {3, 3, 1});
  const TriMesh bar = makeBox({-1, 0.25, 0.25}, {4, 0.75, 0.75});
  struct Row {
    const char* what;
    TriMesh mesh;
    double volume;
    std::size_t pieces;
  };
  const TriMesh hollow = makeHollowBox();
  for (const Row& row : {
           Row{"a U whose corners coincide", together({base, left, right}), 7.0, 3},
           Row{"a bar through a box", together({base, bar}), 3.0 + 0.5, 2},
           Row{"a cross", together({bar, makeBox({1, -2, 0.3}, {2, 3, 0.7})}), 1.25 + 2.0 - 0.2, 2},
           Row{"a copy", together({base, base}), 3.0, 1},
           Row{"three copies", together({base, base, base}), 3.0, 2},
           Row{"a copy that is shifted", together({base, shifted(base, {0, 0.002, 0})}), 3.006, 2},
           Row{"a copy that is shifted in all directions", together({base, shifted(base, {0.1, 0.2, 0.3})}),
               6.0 - 2.9 * 0.8 * 0.7, 2},
           Row{"a box in a box", together({makeBox({0, 0, 0}, {3, 3, 3}), makeBox({1, 1, 1}, {2, 2, 2})}), 27.0, 1},
           Row{"a bar through a cavity", together({hollow, makeBox({1.2, 1.2, -1}, {1.8, 1.8, 4})}), 26.0 + 0.36 * 3.0,
               3},
           Row{"a shell with its cavity, twice", together({hollow, shifted(hollow, {0, 0, 0.5})}), 9.0 * 3.5 - 0.5, 4},
       }) {
    SCOPED_TRACE(row.what);
    const ShellUnion made = united(row.mesh);
    EXPECT_NEAR(volumeOf(made.mesh), row.volume, 1e-9);
    EXPECT_EQ(made.pieces, row.pieces);
  }
}

TEST(ShellUnion, WhatOnlyTouchesStaysAsItIs) {
  const TriMesh box = makeBox({0, 0, 0}, {1, 1, 1});
  for (const TriMesh& mesh :
       {box, together({box, shifted(box, {1, 0, 0})}), together({box, shifted(box, {1, 0.5, 0.5})}),
        together({box, shifted(box, {1, 1, 0})}), together({box, shifted(box, {3, 0, 0})}), makeHollowBox(),
        together({makeHollowBox(), makeBox({1.2, 1.2, 1.2}, {1.8, 1.8, 1.8})})}) {
    EXPECT_FALSE(valueOf(uniteShells(mesh)).has_value());
  }
}

TEST(ShellUnion, StopsWhereTooMuchLiesAcrossTooMuch) {
  // As many cuts of each plate as there are plates across it, for a file of a few hundred kilobytes.
  for (const int plates : {20, 300}) {
    std::vector<TriMesh> grid;
    for (int i = 0; i < plates; ++i) {
      const double at = i, end = plates;
      grid.push_back(makeBox(Vec3(at, -1, 0), Vec3(at + 0.5, end, 1)));
      grid.push_back(makeBox(Vec3(-1, at, 0.1), Vec3(end, at + 0.5, 0.9)));
    }
    const Result<std::optional<ShellUnion>> made = uniteShells(together(grid));
    if (plates == 20) {
      ASSERT_TRUE(made && *made);
      EXPECT_NEAR(volumeOf((*made)->mesh), 20 * 0.5 * 21 * 1.0 + (20 * 0.5 * 21 - 20 * 20 * 0.25) * 0.8, 1e-6);
    } else {
      ASSERT_FALSE(made);
      EXPECT_TRUE(has(made.error().message, "more places than can be resolved"));
    }
  }
}

TEST(ShellUnion, StopsWhereTooManyPiecesAreInEachOther) {
  std::vector<TriMesh> boxes;
  for (int i = 1; i <= 2'500; ++i) boxes.push_back(makeBox(-Vec3::Constant(i), Vec3::Constant(i)));
  const Result<std::optional<ShellUnion>> made = uniteShells(together(boxes));
  ASSERT_FALSE(made);
  EXPECT_TRUE(has(made.error().message, "more places than can be resolved"));
}

TEST(ShellUnion, OfRandomBoxesHoldsItsCells) {
  std::mt19937_64 engine(7);
  const auto whole = [&](int low, int high) { return low + static_cast<int>(engine() % (high - low + 1)); };
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    // Corners on a coarse grid: faces and edges often lie in each other.
    std::array<std::array<std::array<bool, 6>, 6>, 6> cells{};
    std::vector<TriMesh> boxes;
    for (int count = whole(2, 6); count > 0; --count) {
      std::array<int, 3> low{}, high{};
      for (int i = 0; i < 3; ++i) {
        low[i] = whole(0, 4);
        high[i] = whole(low[i] + 1, 6);
      }
      boxes.push_back(makeBox(Vec3(low[0], low[1], low[2]), Vec3(high[0], high[1], high[2])));
      for (int x = low[0]; x < high[0]; ++x) {
        for (int y = low[1]; y < high[1]; ++y) {
          for (int z = low[2]; z < high[2]; ++z) cells[x][y][z] = true;
        }
      }
    }
    int volume = 0;
    for (const auto& plane : cells) {
      for (const auto& row : plane) volume += static_cast<int>(std::ranges::count(row, true));
    }
    const Quat turn = Quat(whole(-9, 9) + 0.5, whole(-9, 9), whole(-9, 9), whole(-9, 9)).normalized();
    const int digits = round % 3;  // as it is; turned; turned, and written with six digits
    const TriMesh mesh = moved(together(boxes), [&](const Vec3& p) -> Vec3 {
      const Vec3 q = turn * p;
      return digits == 0 ? p : digits == 1 ? q : Vec3((q * 1e5).array().round() / 1e5);
    });
    const Result<std::optional<ShellUnion>> made = uniteShells(mesh);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_NEAR(volumeOf(*made ? (*made)->mesh : mesh), volume, digits == 2 ? 2e-3 : 1e-7);
  }
}

/// A tube along a figure of eight, which runs through itself in the middle.
TriMesh makeEight() {
  return moved(insideOut(makeTorus(1.0, 0.2, 96, 16)), [](const Vec3& p) -> Vec3 {
    const double t = std::atan2(p.z(), p.x());
    const Vec3 along(std::cos(t), 0.6 * std::cos(2.0 * t), -0.05 * std::sin(t));
    const Vec3 side = along.cross(Vec3::UnitZ()).normalized();
    const Vec3 center(std::sin(t), 0.3 * std::sin(2.0 * t), 0.05 * std::cos(t));
    return center + (std::hypot(p.x(), p.z()) - 1.0) * side + p.y() * side.cross(along).normalized();
  });
}

TEST(ShellUnion, OfRoundShapesHoldsTheSamePoints) {
  const TriMesh ball = makeSphere(1.0, 24, 36);
  const TriMesh ring = makeTorus(1.0, 0.35, 40, 20);
  for (const TriMesh& mesh :
       {together({ball, shifted(ball, {0.7, 0.2, 0.1})}), together({ball, ring}),
        together({ring, shifted(ring, {1, 0, 0})}), together({ball, makeBox({-2, -0.3, -0.3}, {2, 0.3, 0.3})}),
        together({ball, shifted(ball, {0, 0, 0.001})}), makeEight()}) {
    const ShellUnion made = united(mesh);
    EXPECT_LT(volumeOf(made.mesh), volumeOf(mesh));
    const TriangleTree before(mesh.vertices, mesh.triangles), after(made.mesh.vertices, made.mesh.triangles);
    std::mt19937_64 engine(3);
    const auto unit = [&] { return 4.0 * (static_cast<double>(engine() >> 11) * 0x1p-53) - 2.0; };
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p(unit(), unit(), unit());
      if (before.distance(p) < 1e-3) continue;
      EXPECT_EQ(before.windingNumber(p) > 0.5, after.windingNumber(p) > 0.5) << p.transpose();
    }
  }
}

TEST(ShellUnion, OfTwoScansIsFound) {
  // 139,000 triangles: where they cross, some facets are thinner than a billionth of the diagonal.
  LORICA_REQUIRE_DATASET(file, "vhacd/Bunny.off");
  const TriMesh bunny = valueOf(readMesh(file));
  const Aabb box = boundsOf(bunny.vertices);
  const TriMesh both = joined(bunny, shifted(bunny, (box.max - box.min).cwiseProduct(Vec3(0.3, 0.1, 0.2))));
  EXPECT_NEAR(volumeOf(united(both).mesh), 0.00123091, 1e-8);
}

}  // namespace
}  // namespace lorica::test
