#include "skinning/look/avatar.h"

#include "skinning/look/expressed_materials.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

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

/// KHR_texture_transform: moved, turned, scaled.
Eigen::Matrix<float, 2, 3> transformOf(float offset, float rotation, float scale) {
  const float c = std::cos(rotation), s = std::sin(rotation);
  Eigen::Matrix<float, 2, 3> transform;
  transform << c * scale, s * 2.0f * scale, offset, -s * scale, c * 2.0f * scale, -offset;
  return transform;
}

Expression expressionOf(const std::string& name) {
  Expression expression;
  expression.name = name;
  return expression;
}

TEST(ExpressedMaterials, ExpressionsAddUpFromTheFilesValues) {
  std::array<Material, 2> materials;
  materials[1].baseColor = {0.5f, 0.5f, 0.5f, 0.5f};
  std::array<Material, 2> shown = materials;
  Expression red = expressionOf("red");
  red.colors = {{1, MaterialColor::kBase, {1.0f, 0.5f, 0.5f, 0.5f}}};
  Expression clear = expressionOf("clear");
  clear.colors = {{1, MaterialColor::kBase, {0.5f, 0.5f, 0.5f, 0.0f}}};
  Expressions expressions;
  EXPECT_FALSE(changesMaterials(expressions));
  addExpression(expressions, red);
  addExpression(expressions, clear);
  EXPECT_TRUE(changesMaterials(expressions));
  for (int repeat = 0; repeat < 2; ++repeat) {  // nothing accumulates over frames
    expressMaterials(expressions, std::array{0.5f, 0.25f}, materials, shown);
    EXPECT_EQ(shown[1].baseColor, Eigen::Vector4f(0.75f, 0.5f, 0.5f, 0.375f));
    EXPECT_EQ(shown[0].baseColor, materials[0].baseColor);
  }
  expressMaterials(expressions, std::array{0.0f, 0.0f}, materials, shown);
  EXPECT_EQ(shown[1].baseColor, materials[1].baseColor);
}

TEST(ExpressedMaterials, ScaleAndOffsetOfAllTexturesButTheMatcapAreBlendedAndTheirRotationsKept) {
  std::array<Material, 1> materials;
  Material& material = materials[0];
  material.base.rotation = 0.7f;
  material.base.transform = transformOf(0.1f, 0.7f, 3.0f);
  std::array<Material, 1> shown = materials;
  Expression moved = expressionOf("moved");
  moved.textures = {{0, {1.0f, 2.0f}, {0.5f, -0.5f}}};
  Expressions expressions;
  addExpression(expressions, moved);
  expressMaterials(expressions, std::array{0.25f}, materials, shown);
  EXPECT_TRUE(shown[0].base.transform.isApprox(transformOf(0.2f, 0.7f, 2.5f), 1e-6f)) << shown[0].base.transform;
  const TextureUse plain;
  int changed = 0;
  for (const TextureUse* use : shown[0].textures()) changed += use->transform != plain.transform ? 1 : 0;
  EXPECT_EQ(changed, 10);
  EXPECT_EQ(shown[0].toon.matcap.transform, plain.transform);
}

}  // namespace
}  // namespace lorica
