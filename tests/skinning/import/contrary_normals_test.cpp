#include "skinning/import/contrary_normals.h"

#include "geometry/counts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lorica {
namespace {

std::vector<Vec3f> outwards(const TriMesh& mesh) {
  std::vector<Vec3f> normals;
  for (const Vec3& p : mesh.vertices) normals.push_back(p.normalized().cast<float>());
  return normals;
}

/// About the origin.
TriMesh ball() {
  return test::makeSphere(1.0, 12, 16);
}

double leastAgreement(const TriMesh& mesh, const std::vector<Vec3f>& normals) {
  double least = 1.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3 face = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized();
    for (const VertexIndex v : t) least = std::min(least, face.dot(normals[v].cast<double>()));
  }
  return least;
}

TEST(ContraryNormals, AreReplacedWhereTheTrianglesAgree) {
  TriMesh mesh = ball();
  std::vector<Vec3f> normals = outwards(mesh);
  const std::vector<Vec3f> right = normals;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    if (mesh.vertices[v].y() > 0.0) normals[v] = -normals[v];
  }
  EXPECT_EQ(mendContraryNormals(mesh.vertices, mesh.triangles, normals), ContraryNormals::kNormalsReplaced);
  for (std::size_t v = 0; v < normals.size(); ++v) EXPECT_GT(normals[v].dot(right[v]), 0.99F);
}

TEST(ContraryNormals, TurnTrianglesThatDoNotAgree) {
  TriMesh mesh = ball();
  std::vector<Vec3f> normals = outwards(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 2) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  EXPECT_EQ(mendContraryNormals(mesh.vertices, mesh.triangles, normals), ContraryNormals::kTrianglesTurned);
  EXPECT_EQ(normals, outwards(mesh));
  EXPECT_GT(leastAgreement(mesh, normals), 0.9);
}

TEST(ContraryNormals, KeepEdgesAndSeams) {
  // Each corner of the box has three vertices, one for each face.
  TriMesh mesh;
  for (const Triangle& t : test::makeBox(Vec3(-1.0, -1.0, -1.0), Vec3(1.0, 1.0, 1.0)).triangles) {
    const TriMesh box = test::makeBox(Vec3(-1.0, -1.0, -1.0), Vec3(1.0, 1.0, 1.0));
    const VertexIndex first = countOf(mesh.vertices);
    for (const VertexIndex v : t) mesh.vertices.push_back(box.vertices[v]);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  std::vector<Vec3f> normals = outwards(mesh);
  for (Vec3f& n : normals) n = -n;
  EXPECT_EQ(mendContraryNormals(mesh.vertices, mesh.triangles, normals), ContraryNormals::kNormalsReplaced);
  EXPECT_GT(leastAgreement(mesh, normals), 0.999);
}

TEST(ContraryNormals, LeaveWhatFacesBothWays) {
  TriMesh mesh{{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}, {{0, 1, 2}, {0, 2, 1}}};
  std::vector<Vec3f> normals(3, Vec3f::UnitZ());
  EXPECT_EQ(mendContraryNormals(mesh.vertices, mesh.triangles, normals), ContraryNormals::kNone);
  EXPECT_EQ(normals, std::vector<Vec3f>(3, Vec3f::UnitZ()));
  TriMesh sound = ball();
  std::vector<Vec3f> right = outwards(sound);
  EXPECT_EQ(mendContraryNormals(sound.vertices, sound.triangles, right), ContraryNormals::kNone);
}

}  // namespace
}  // namespace lorica
