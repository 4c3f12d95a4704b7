// What expressions change of an avatar's materials, by closed forms.

#include "skinning/look/expressed_materials.h"
#include "tests/viewer/renderer/avatars.h"
#include "tests/viewer/renderer/pictures.h"

#include <gtest/gtest.h>

#include <array>

namespace lorica {
namespace {

using test::AvatarMaker;
using test::AvatarOnStage;
using test::byteOf;

constexpr int kSize = 96;

/// The middle of a picture with one expression at a weight.
std::array<int, 3> middleWith(test::Studio& studio, const AvatarOnStage& stage, const Expression& expression,
                              float weight, const AvatarLight& light = test::dark()) {
  Expressions expressions;
  addExpression(expressions, expression);
  std::vector<Material> shown = stage.avatar->look.materials;
  expressMaterials(expressions, std::array{weight}, stage.avatar->look.materials, shown);
  Scene scene = stage.scene();
  scene.avatarMaterials = shown;
  return test::pixelAt(studio.draw(scene, test::onBlack(light), test::frontCamera(), kSize, kSize), kSize / 2,
                       kSize / 2);
}

void expectColor(const std::array<int, 3>& found, const Vec3f& linear, const std::string& what) {
  for (Eigen::Index c = 0; c < 3; ++c) EXPECT_NEAR(found[c], byteOf(linear[c]), 1) << what << ", channel " << c;
}

/// A material that shows one of its colours and nothing else, in a key light of 1 for shades and without light for
/// other colours.
Material showing(MaterialColor color, const Vec3f& value, AvatarMaker& maker) {
  Material material;
  material.shading = color == MaterialColor::kBase ? Shading::kUnlit : Shading::kToon;
  material.baseColor = {1, 1, 1, 1};
  material.toon.rimLightingMix = 0.0f;
  if (color == MaterialColor::kBase) material.baseColor.head<3>() = value;
  if (color == MaterialColor::kEmission) {
    material.emissive = value;
    material.emissiveStrength = 0.5f;
  }
  if (color == MaterialColor::kShade) {
    material.toon.shadeColor = value;
    material.toon.shift = -2.0f;  // the light reaches nothing
  }
  if (color == MaterialColor::kRim) {
    material.toon.rimColor = value;
    material.toon.rimLift = 1.0f;  // the rim is everywhere
  }
  if (color == MaterialColor::kMatcap) {
    material.toon.matcapFactor = value;
    material.toon.matcap = maker.picture({255, 255, 255, 255});
  } else {
    material.toon.matcapFactor.setZero();
  }
  return material;
}

TEST(AvatarExpression, ColorsAreBlendedLinearlyAndGoBack) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const Vec3f base(0.8f, 0.5f, 0.2f), target(0.1f, 0.9f, 0.6f);
  for (const MaterialColor color : {MaterialColor::kBase, MaterialColor::kEmission, MaterialColor::kShade,
                                    MaterialColor::kRim, MaterialColor::kMatcap}) {
    AvatarMaker maker;
    maker.material(showing(color, base, maker));
    maker.add({});
    const AvatarOnStage stage(maker.avatar);
    AvatarLight light = test::dark();
    if (color == MaterialColor::kShade) light.key.setOnes();
    Expression expression;
    expression.name = "made";
    expression.colors = {{0, color, {target.x(), target.y(), target.z(), 1.0f}}};
    for (const float weight : {0.0f, 0.25f, 1.0f, 0.0f}) {
      const float strength = color == MaterialColor::kEmission ? 0.5f : 1.0f;
      expectColor(middleWith(*studio, stage, expression, weight, light), strength * (base + weight * (target - base)),
                  "colour " + std::to_string(static_cast<int>(color)) + " at " + std::to_string(weight));
    }
  }
}

TEST(AvatarExpression, OpacityIsBlendedOnBlendedMaterials) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  Material material;
  material.shading = Shading::kUnlit;
  material.alpha = AlphaMode::kBlend;
  material.baseColor = {1, 1, 1, 0};  // a blush that an expression shows
  maker.material(material);
  maker.add({});
  const AvatarOnStage stage(maker.avatar);
  Expression blush;
  blush.name = "blush";
  blush.colors = {{0, MaterialColor::kBase, {1.0f, 1.0f, 1.0f, 0.8f}}};
  for (const float weight : {0.0f, 0.5f, 1.0f}) {
    EXPECT_NEAR(middleWith(*studio, stage, blush, weight)[0], 255.0f * 0.8f * weight, 1) << weight;
  }
}

TEST(AvatarExpression, OutlinesTakeTheirColor) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  Material material;
  material.shading = Shading::kToon;
  material.toon.outline = OutlineMode::kWorld;
  material.toon.outlineWidth = 0.3f;
  material.toon.outlineLightingMix = 0.0f;
  material.toon.outlineColor = {0, 0, 1};
  maker.material(material);
  maker.addSphere({0.5, 1, 0}, 0.4, 32, 48);  // the middle of the picture is in its outline
  const AvatarOnStage stage(maker.avatar);
  Expression expression;
  expression.name = "made";
  expression.colors = {{0, MaterialColor::kOutline, {1.0f, 0.0f, 0.0f, 1.0f}}};
  for (const float weight : {0.0f, 0.3f}) {
    expectColor(middleWith(*studio, stage, expression, weight), Vec3f(weight, 0.0f, 1.0f - weight),
                std::to_string(weight));
  }
}

TEST(AvatarExpression, TextureCoordinatesMove) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::array<Vec3f, 4> colors = {Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1), Vec3f(1, 1, 1)};
  AvatarMaker maker;
  Material material;
  material.shading = Shading::kUnlit;
  material.base = maker.picture(4, 1, {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}});
  maker.material(material);
  AvatarMaker::Quad quad;
  quad.uLeft = quad.uRight = 0.125f;  // red at first
  maker.add(quad);
  const AvatarOnStage stage(maker.avatar);
  Expression moved;
  moved.name = "moved";
  moved.textures = {{0, {1.0f, 1.0f}, {0.5f, 0.0f}}};
  expectColor(middleWith(*studio, stage, moved, 0.0f), colors[0], "at 0");
  expectColor(middleWith(*studio, stage, moved, 0.5f), colors[1], "half");
  expectColor(middleWith(*studio, stage, moved, 1.0f), colors[2], "whole");
  moved.textures = {{0, {5.0f, 1.0f}, {0.0f, 0.0f}}};  // 5 x 0.125: the third texel
  expectColor(middleWith(*studio, stage, moved, 1.0f), colors[2], "scaled");
}

}  // namespace
}  // namespace lorica
