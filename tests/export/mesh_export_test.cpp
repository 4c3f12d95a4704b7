#include "export/mesh_export.h"

#include "geometry/files.h"

#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

std::vector<NamedMesh> twoSolids() {
  TriMesh box = test::makeBox(Vec3(-1.0, 0.0, 2.0), Vec3(0.25, 1.0 / 3.0, 3.0));
  return {{"box of a hand", std::move(box)}, {"tetrahedron", test::makeTetrahedron()}};
}

class MeshFormat : public testing::TestWithParam<const char*> {};

TEST_P(MeshFormat, IsReadBackToNineDigitsWhereverItIs) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / (std::string("hulls") + GetParam());
  for (const Vec3& away : {Vec3(0.0, 0.0, 0.0), Vec3(5e6, -3.0, 0.0)}) {
    std::vector<NamedMesh> solids = twoSolids();
    for (NamedMesh& solid : solids) {
      for (Vec3& p : solid.mesh.vertices) p += away;
    }
    ASSERT_TRUE(writeMeshes(file, solids).ok());
    TriMesh read = readMesh(file).value();
    EXPECT_EQ(read.triangles.size(), 16U);
    EXPECT_EQ(read.vertices.size(), 12U);
    for (Vec3& p : read.vertices) p -= away;
    EXPECT_NEAR(signedVolume(read.vertices, read.triangles), 1.25 / 3.0 + 1.0 / 6.0, 1e-8);
    EXPECT_LT((surfaceBounds(read).min - Vec3(-1.0, 0.0, 0.0)).norm(), 1e-8);
  }
  ASSERT_TRUE(writeMeshes(file, twoSolids()).ok());
  EXPECT_TRUE(test::has(readFile(file).value(), " 0.333333333"));
  EXPECT_FALSE(test::has(readFile(file).value(), " 0.3333333333"));
}

INSTANTIATE_TEST_SUITE_P(, MeshFormat, testing::Values(".obj", ".stl", ".ply", ".STL"),
                         [](const auto& each) { return "as" + std::to_string(each.index) + (each.param + 1); });

TEST(MeshExport, NamesOfPartsAreInTheFilePlainAndUnique) {
  const std::string stl = formatMeshes(twoSolids(), ".stl"), ply = formatMeshes(twoSolids(), ".ply");
  EXPECT_TRUE(test::has(stl, "solid box_of_a_hand\n"));
  EXPECT_TRUE(test::has(stl, "endsolid tetrahedron\n"));
  EXPECT_TRUE(test::has(ply, "comment part 1 tetrahedron\n"));
  EXPECT_TRUE(test::has(ply, "\n3 8 10 9 1\n"));
  EXPECT_EQ(plainNames({"Hips", "Hips", "Hips_2", "\xe8\x85\xb0<\"", "", "a b"}),
            (std::vector<std::string>{"Hips", "Hips_2", "Hips_2_2", "_____", "_", "a_b"}));
}

TEST(MeshExport, BinaryStlHasOneRecordForEachTriangle) {
  const test::TemporaryFolder folder;
  const std::string bytes = formatBinaryStl(test::makeTetrahedron());
  EXPECT_EQ(bytes.size(), 84U + 4U * 50U);
  const TriMesh read = readMesh(folder.write("t.stl", bytes)).value();
  EXPECT_DOUBLE_EQ(signedVolume(read.vertices, read.triangles), 1.0 / 6.0);
}

TEST(MeshExport, LeavesNothingWhereItCannotWrite) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(writeMeshes(folder.path() / "no" / "hulls.stl", twoSolids()).ok());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace lorica
