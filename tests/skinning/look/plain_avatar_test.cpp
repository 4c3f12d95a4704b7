#include "skinning/look/avatar.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(PlainAvatar, NormalsOfACubeAreSmooth) {
  Character cube;
  cube.name = "cube";
  for (int corner = 0; corner < 8; ++corner) {
    cube.mesh.vertices.emplace_back(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
  }
  // Two triangles a side, so that each corner has one or two of them: four of the corners see each side equally.
  cube.mesh.triangles = {{0, 6, 2}, {0, 4, 6}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                         {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  Material material;
  material.name = "clay";
  const std::shared_ptr<const Avatar> avatar = makePlainAvatar(cube, material);
  EXPECT_TRUE(avatar->plain);
  ASSERT_EQ(avatar->look.groups.size(), 1u);
  EXPECT_EQ(avatar->look.groups[0].triangleCount, 12u);
  EXPECT_EQ(avatar->look.materials.at(0).name, "clay");
  ASSERT_EQ(avatar->look.normals.size(), 8u);
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3f& normal = avatar->look.normals[v];
    EXPECT_NEAR(normal.norm(), 1.0f, 1e-6f);
    EXPECT_GT(normal.dot(cube.mesh.vertices[v].cast<float>().normalized()), 0.8f) << v;
  }
  EXPECT_TRUE(avatar->look.normals[0].isApprox(Vec3f(-1, -1, -1).normalized(), 1e-6f));
}

}  // namespace
}  // namespace lorica
