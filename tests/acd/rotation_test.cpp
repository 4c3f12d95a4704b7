// Parts do not depend on how a mesh lies.

#include "acd/mesh_frame.h"
#include "geometry/mesh_files.h"
#include "geometry/random_numbers.h"
#include "tests/acd/parts.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <array>

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

TriMesh turned(const TriMesh& mesh, const Mat3& rotation) {
  return test::moved(mesh, [&](const Vec3& v) -> Vec3 { return rotation * v + Vec3(3.0, -1.0, 2.0); });
}

/// A closed surface around the cells of a grid that are solid.
TriMesh solidCells(const std::array<std::vector<double>, 3>& grid, const auto& solid) {
  std::set<test::Voxel> cells;
  for (int x = 0; x + 1 < countOf(grid[0]); ++x) {
    for (int y = 0; y + 1 < countOf(grid[1]); ++y) {
      for (int z = 0; z + 1 < countOf(grid[2]); ++z) {
        if (solid(x, y, z)) cells.insert({x, y, z});
      }
    }
  }
  return test::moved(test::makeVoxelSurface(cells), [&](const Vec3& v) {
    return Vec3(grid[0][static_cast<int>(v.x())], grid[1][static_cast<int>(v.y())], grid[2][static_cast<int>(v.z())]);
  });
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
  const Decomposition made = test::decomposed(mesh, {.maxParts = parts, .preset = preset});
  return errorInPose(made, mesh, mesh.vertices).relative();
}

class Rotation : public ::testing::TestWithParam<DecomposePreset> {};

TEST_P(Rotation, TablesRingsAndHandlesAreTheirBoxesHoweverTheyLie) {
  for (const auto& [mesh, boxes] : {std::pair{makeTable(), 5}, {makeFrame(), 4}, {makeHandle(), 4}}) {
    for (int i = 0; i < kRotations; ++i) {
      EXPECT_NEAR(errorOf(turned(mesh, randomRotation(i)), boxes, GetParam()), 0.0, 1e-6) << "rotation " << i;
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
  const TriMesh sledge = test::valueOf(readMesh(file));
  const double error = errorOf(sledge, 14, GetParam());
  for (int i = 0; i < kRotations; ++i) {
    EXPECT_NEAR(errorOf(turned(sledge, randomRotation(i)), 14, GetParam()), error, 1e-6) << "rotation " << i;
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
