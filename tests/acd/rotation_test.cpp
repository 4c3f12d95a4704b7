// Parts do not depend on how a mesh lies.

#include "acd/decompose.h"
#include "acd/mesh_frame.h"
#include "acd/transfer.h"
#include "geometry/mesh_files.h"
#include "geometry/random_numbers.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

namespace lorica {
namespace {

constexpr int kRotations = 8;

Mat3 randomRotation(int seed) {
  RandomNumbers random(static_cast<std::uint64_t>(seed));
  Eigen::Vector4d q;
  do {
    for (double& x : q) x = random.between(-1.0, 1.0);
  } while (q.norm() > 1.0 || q.norm() < 0.1);
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

TriMesh turned(TriMesh mesh, const Mat3& rotation) {
  for (Vec3& v : mesh.vertices) v = rotation * v + Vec3(3.0, -1.0, 2.0);
  return mesh;
}

/// A closed surface around the cells of a grid that are solid.
TriMesh solidCells(const std::array<std::vector<double>, 3>& grid, const auto& solid) {
  TriMesh mesh;
  std::map<std::array<int, 3>, VertexIndex> numberOf;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [entry, isNew] = numberOf.try_emplace(at, static_cast<VertexIndex>(mesh.vertices.size()));
    if (isNew) mesh.vertices.emplace_back(grid[0][at[0]], grid[1][at[1]], grid[2][at[2]]);
    return entry->second;
  };
  const auto isSolid = [&](const std::array<int, 3>& c) {
    for (int i = 0; i < 3; ++i) {
      if (c[i] < 0 || c[i] + 1 >= static_cast<int>(grid[i].size())) return false;
    }
    return solid(c[0], c[1], c[2]);
  };
  std::array<int, 3> c{};
  for (c[0] = 0; c[0] + 1 < static_cast<int>(grid[0].size()); ++c[0]) {
    for (c[1] = 0; c[1] + 1 < static_cast<int>(grid[1].size()); ++c[1]) {
      for (c[2] = 0; c[2] + 1 < static_cast<int>(grid[2].size()); ++c[2]) {
        if (!isSolid(c)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (const int side : {0, 1}) {
            std::array<int, 3> next = c;
            next[axis] += 2 * side - 1;
            if (isSolid(next)) continue;
            std::array<VertexIndex, 4> corner{};
            for (int i = 0; i < 4; ++i) {
              std::array<int, 3> at = c;
              at[axis] += side;
              at[(axis + 1) % 3] += i == 1 || i == 2 ? 1 : 0;
              at[(axis + 2) % 3] += i >= 2 ? 1 : 0;
              corner[i] = vertex(at);
            }
            if (side == 0) std::swap(corner[1], corner[3]);
            mesh.triangles.push_back({corner[0], corner[1], corner[2]});
            mesh.triangles.push_back({corner[0], corner[2], corner[3]});
          }
        }
      }
    }
  }
  return mesh;
}

/// A top on four legs: five boxes.
TriMesh makeTable() {
  const std::array<std::vector<double>, 3> grid = {
      {{-4.0, -3.76, -3.44, 3.44, 3.76, 4.0}, {-2.125, 0.875, 1.125}, {-2.0, -1.76, -1.44, 1.44, 1.76, 2.0}}};
  return solidCells(grid, [](int x, int y, int z) { return y == 1 || ((x == 1 || x == 3) && (z == 1 || z == 3)); });
}

/// A square frame: four boxes.
TriMesh makeFrame() {
  const std::array<std::vector<double>, 3> grid = {{{0.0, 0.3, 1.7, 2.0}, {0.0, 0.4, 2.1, 2.5}, {0.0, 0.5}}};
  return solidCells(grid, [](int x, int y, int) { return x != 1 || y != 1; });
}

/// A block with a handle on one side: four boxes.
TriMesh makeHandle() {
  const std::array<std::vector<double>, 3> grid = {
      {{0.0, 1.0, 1.6, 1.9}, {0.0, 0.4, 0.7, 1.9, 2.2, 2.5}, {0.0, 0.3, 0.7, 1.0}}};
  return solidCells(grid, [](int x, int y, int z) {
    const bool arm = x == 1 && (y == 1 || y == 3), bar = x == 2 && y >= 1 && y <= 3;
    return x == 0 || (z == 1 && (arm || bar));
  });
}

/// Two unit boxes with a gap between them.
TriMesh makePair(double gap) {
  return test::joined(test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({1 + gap, 0.3, 0.2}, {2 + gap, 1.3, 1.2}));
}

double errorOf(const TriMesh& mesh, int parts, DecomposePreset preset) {
  DecomposeSettings settings;
  settings.maxParts = parts;
  settings.preset = preset;
  const Result<Decomposition> made = decompose(mesh, {mesh.vertices, static_cast<int>(mesh.vertices.size())}, settings);
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message);
  std::vector<Vec3> points(static_cast<std::size_t>(made->pointCount()));
  transfer(*made, mesh.vertices, points);
  double volume = 0.0;
  for (const ConvexHull& hull : partHulls(*made, points)) volume += hull.volume;
  const double own = signedVolume(mesh.vertices, mesh.triangles);
  return (volume - own) / own;
}

class Rotation : public ::testing::TestWithParam<DecomposePreset> {};

TEST_P(Rotation, TableIsFiveBoxesHoweverItLies) {
  const TriMesh table = makeTable();
  for (int i = 0; i < kRotations; ++i) {
    EXPECT_NEAR(errorOf(turned(table, randomRotation(i)), 5, GetParam()), 0.0, 1e-6) << "rotation " << i;
  }
}

TEST_P(Rotation, RingsAndHandlesAreTheirBoxesHoweverTheyLie) {
  for (const TriMesh& mesh : {makeFrame(), makeHandle()}) {
    for (int i = 0; i < kRotations; ++i) {
      EXPECT_NEAR(errorOf(turned(mesh, randomRotation(i)), 4, GetParam()), 0.0, 1e-6) << "rotation " << i;
    }
  }
}

TEST_P(Rotation, SeparateBoxesAreTwoPartsHoweverCloseTheyAre) {
  for (const double gap : {1.0, 0.1, 0.01, 0.001}) {
    EXPECT_NEAR(errorOf(makePair(gap), 2, GetParam()), 0.0, 1e-6) << "gap " << gap;
    EXPECT_NEAR(errorOf(turned(makePair(gap), randomRotation(1)), 2, GetParam()), 0.0, 1e-6) << "gap " << gap;
  }
}

TEST_P(Rotation, ErrorOfATorusHardlyDependsOnIt) {
  const TriMesh torus = test::makeTorus(1.0, 0.4, 24, 12);
  const double error = errorOf(torus, 6, GetParam());
  for (int i = 0; i < kRotations; ++i) {
    EXPECT_NEAR(errorOf(turned(torus, randomRotation(i)), 6, GetParam()), error, 0.01) << "rotation " << i;
  }
}

TEST_P(Rotation, MorePartsAreNotWorse) {
  const TriMesh torus = test::makeTorus(1.0, 0.4, 24, 12);
  double before = errorOf(torus, 1, GetParam());
  for (int parts = 2; parts <= 24; ++parts) {
    const double error = errorOf(torus, parts, GetParam());
    EXPECT_LE(error, before + 0.002) << parts << " parts";
    before = error;
  }
}

TEST_P(Rotation, AMeshOfAFileHasTheSameErrorHoweverItLies) {
  LORICA_REQUIRE_DATASET(file, "vhacd/Sledge.off");
  const Result<TriMesh> sledge = readMesh(file);
  ASSERT_TRUE(sledge.ok());
  const double error = errorOf(*sledge, 14, GetParam());
  for (int i = 0; i < kRotations; ++i) {
    EXPECT_NEAR(errorOf(turned(*sledge, randomRotation(i)), 14, GetParam()), error, 1e-6) << "rotation " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, Rotation, ::testing::Values(DecomposePreset::kFast, DecomposePreset::kQuality));

TEST(Rotation, QualityIsNotWorseThanFast) {
  for (const TriMesh& mesh : {makeTable(), test::makeTorus(1.0, 0.4, 24, 12), test::makeLShape()}) {
    for (const int parts : {2, 3, 5, 8, 13}) {
      EXPECT_LE(errorOf(mesh, parts, DecomposePreset::kQuality), errorOf(mesh, parts, DecomposePreset::kFast) + 1e-9);
    }
  }
}

TEST(MeshFrame, IsThatOfTheFacesExactly) {
  const TriMesh table = makeTable();
  const Mat3 frame = frameOf(table.vertices, table.triangles);
  EXPECT_EQ(frame.cwiseAbs().sum(), 3.0);  // a permutation
  EXPECT_EQ(frame.determinant(), 1.0);
}

TEST(MeshFrame, TurnsWithTheMesh) {
  // Without symmetries, so that the frame has only one solution.
  const std::array<std::vector<double>, 3> grid = {{{0.0, 1.0, 3.0}, {0.0, 1.0, 2.5}, {0.0, 1.0, 2.2}}};
  const TriMesh steps = solidCells(grid, [](int x, int y, int z) { return x + y + z < 2; });
  TriMesh ball = test::makeSphere(1.0, 12, 16);
  for (Vec3& v : ball.vertices) v = Vec3(3.0 * v.x() + 0.5 * v.x() * v.x(), 2.0 * v.y() + 0.3 * v.y() * v.y(), v.z());
  for (const TriMesh& mesh : {steps, ball}) {
    const Mat3 frame = frameOf(mesh.vertices, mesh.triangles);
    EXPECT_TRUE((frame * frame.transpose()).isIdentity(1e-12));
    for (int i = 0; i < kRotations; ++i) {
      const Mat3 rotation = randomRotation(i);
      const TriMesh other = turned(mesh, rotation);
      EXPECT_TRUE((frameOf(other.vertices, other.triangles) * rotation).isApprox(frame, 1e-6)) << "rotation " << i;
    }
  }
}

}  // namespace
}  // namespace lorica
