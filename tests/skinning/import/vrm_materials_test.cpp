#include "skinning/import/vrm_materials.h"

#include "tests/skinning/import/material_samples.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

using test::dressedCharacter;
using test::GlbWriter;
using test::notesWith;
using test::parsed;
using test::pictureOf;
using Json = nlohmann::json;

[[nodiscard]] Json mtoon1(const Json& members) {
  return {{"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0.5, 0.75, 1.0}}, {"baseColorTexture", {{"index", 0}}}}},
          {"extensions", {{"VRMC_materials_mtoon", members}}}};
}

/// A VRM 0.x file whose materials have these properties.
[[nodiscard]] Result<CharacterFile> vrm0(const std::vector<Json>& properties) {
  GlbWriter writer = dressedCharacter({{"name", "0"}, {"emissiveFactor", {1, 1, 1}}});
  Json& primitives = writer.document["meshes"][0]["primitives"];
  for (std::size_t m = 1; m < properties.size(); ++m) {
    writer.document["materials"].push_back({{"name", std::to_string(m)}});
    primitives.push_back(primitives[0]);
    primitives[m]["material"] = m;
  }
  writer.document["extensions"]["VRM"] = {
      {"specVersion", "0.0"}, {"humanoid", {{"humanBones", Json::array()}}}, {"materialProperties", properties}};
  return parsed(writer);
}

[[nodiscard]] Material onlyOf(const Json& properties) {
  return test::valueOf(vrm0({properties})).look.materials.at(0);
}

/// Unity's gamma, as three-vrm and UniVRM convert it.
[[nodiscard]] float linear(double encoded) {
  return static_cast<float>(std::pow(encoded, 2.2));
}

void expectColor(const Vec3f& color, double r, double g, double b) {
  EXPECT_NEAR(color.x(), linear(r), 1e-6F);
  EXPECT_NEAR(color.y(), linear(g), 1e-6F);
  EXPECT_NEAR(color.z(), linear(b), 1e-6F);
}

TEST(Mtoon1, EveryFieldIsRead) {
  const CharacterFile file = test::valueOf(parsed(dressedCharacter(mtoon1(Json::parse(R"({
    "specVersion": "1.0", "transparentWithZWrite": true, "renderQueueOffsetNumber": 4,
    "shadeColorFactor": [0.5, 0.25, 0.125], "shadeMultiplyTexture": {"index": 1}, "shadingShiftFactor": -0.25,
    "shadingShiftTexture": {"index": 2, "scale": 0.5, "texCoord": 1}, "shadingToonyFactor": 0.75,
    "matcapTexture": {"index": 3}, "matcapFactor": [0.5, 0.625, 0.75], "rimMultiplyTexture": {"index": 4},
    "parametricRimColorFactor": [0.25, 0.5, 1.0], "parametricRimFresnelPowerFactor": 3.0,
    "parametricRimLiftFactor": 0.125, "rimLightingMixFactor": 0.375, "outlineWidthMode": "screenCoordinates",
    "outlineWidthFactor": 0.0625, "outlineWidthMultiplyTexture": {"index": 5},
    "outlineColorFactor": [0.125, 0.25, 0.375], "outlineLightingMixFactor": 0.5, "giEqualizationFactor": 0.625,
    "uvAnimationMaskTexture": {"index": 6}, "uvAnimationScrollXSpeedFactor": 0.5,
    "uvAnimationScrollYSpeedFactor": -0.25, "uvAnimationRotationSpeedFactor": 2.0})")))));
  EXPECT_TRUE(file.notes.empty()) << file.notes.front();
  const Material& m = file.look.materials.at(0);
  EXPECT_EQ(m.shading, Shading::kToon);
  EXPECT_EQ(m.baseColor, Eigen::Vector4f(0.25F, 0.5F, 0.75F, 1.0F));
  EXPECT_EQ(pictureOf(file, m.base), "picture 0");
  EXPECT_TRUE(m.blendWritesDepth);
  EXPECT_EQ(m.drawOrder, 4);
  const ToonMaterial& toon = m.toon;
  EXPECT_EQ(toon.shadeColor, Vec3f(0.5F, 0.25F, 0.125F));
  EXPECT_EQ(pictureOf(file, toon.shade), "picture 1");
  EXPECT_EQ(toon.shift, -0.25F);
  EXPECT_EQ(pictureOf(file, toon.shiftTexture), "picture 2");
  EXPECT_EQ(toon.shiftTexture.uvSet, 1);
  EXPECT_EQ(toon.shiftScale, 0.5F);
  EXPECT_EQ(toon.toony, 0.75F);
  EXPECT_EQ(pictureOf(file, toon.matcap), "picture 3");
  EXPECT_EQ(toon.matcapFactor, Vec3f(0.5F, 0.625F, 0.75F));
  EXPECT_EQ(toon.rimColor, Vec3f(0.25F, 0.5F, 1.0F));
  EXPECT_EQ(toon.rimPower, 3.0F);
  EXPECT_EQ(toon.rimLift, 0.125F);
  EXPECT_EQ(pictureOf(file, toon.rim), "picture 4");
  EXPECT_EQ(toon.rimLightingMix, 0.375F);
  EXPECT_EQ(toon.outline, OutlineMode::kScreen);
  EXPECT_EQ(toon.outlineWidth, 0.0625F);
  EXPECT_EQ(pictureOf(file, toon.outlineWidthTexture), "picture 5");
  EXPECT_EQ(toon.outlineColor, Vec3f(0.125F, 0.25F, 0.375F));
  EXPECT_EQ(toon.outlineLightingMix, 0.5F);
  EXPECT_EQ(toon.giEqualization, 0.625F);
  EXPECT_EQ(pictureOf(file, toon.uvAnimationMask), "picture 6");
  EXPECT_EQ(toon.uvScroll, Eigen::Vector2f(0.5F, -0.25F));
  EXPECT_EQ(toon.uvRotation, 2.0F);
}

// https://github.com/vrm-c/vrm-specification/blob/master/specification/VRMC_materials_mtoon-1.0/README.md
TEST(Mtoon1, DefaultsAreTheSpecifications) {
  Json material = mtoon1({{"specVersion", "1.0"}});
  material["extensions"]["KHR_materials_unlit"] = Json::object();  // MToon takes precedence
  const CharacterFile file = test::valueOf(parsed(dressedCharacter(material)));
  const Material& m = file.look.materials.at(0);
  EXPECT_EQ(m.shading, Shading::kToon);
  EXPECT_FALSE(m.blendWritesDepth);
  const ToonMaterial& toon = m.toon;
  EXPECT_EQ(toon.shadeColor, Vec3f(0, 0, 0));
  EXPECT_EQ(toon.shift, 0.0F);
  EXPECT_EQ(toon.shiftScale, 1.0F);
  EXPECT_EQ(toon.toony, 0.9F);
  EXPECT_EQ(toon.matcapFactor, Vec3f(0, 0, 0)) << "there is no matcap";
  EXPECT_EQ(toon.rimColor, Vec3f(0, 0, 0));
  EXPECT_EQ(toon.rimPower, 5.0F);
  EXPECT_EQ(toon.rimLift, 0.0F);
  EXPECT_EQ(toon.rimLightingMix, 1.0F);
  EXPECT_EQ(toon.outline, OutlineMode::kNone);
  EXPECT_EQ(toon.outlineWidth, 0.0F);
  EXPECT_EQ(toon.outlineColor, Vec3f(0, 0, 0));
  EXPECT_EQ(toon.outlineLightingMix, 1.0F);
  EXPECT_EQ(toon.uvScroll, Eigen::Vector2f(0, 0));
  EXPECT_EQ(toon.uvRotation, 0.0F);
}

TEST(Mtoon1, MaterialsThatWriteDepthComeBeforeAllOthers) {
  const auto orderOf = [](bool writes, double offset) {
    const Result<CharacterFile> file =
        parsed(dressedCharacter(mtoon1({{"transparentWithZWrite", writes}, {"renderQueueOffsetNumber", offset}})));
    EXPECT_TRUE(file.ok());
    return file->look.materials.at(0).drawOrder;
  };
  EXPECT_LT(orderOf(true, 0), orderOf(true, 9));
  EXPECT_LT(orderOf(true, 9), orderOf(false, -9));
  EXPECT_LT(orderOf(false, -9), orderOf(false, 0));
  // Outside the range of the specification.
  EXPECT_EQ(orderOf(true, 1e30), orderOf(true, 9));
  EXPECT_EQ(orderOf(true, -5), orderOf(true, 0));
  EXPECT_EQ(orderOf(false, -1e30), orderOf(false, -9));
  EXPECT_EQ(orderOf(false, 5), orderOf(false, 0));
}

TEST(Mtoon1, VertexColorsAreIgnored) {
  GlbWriter writer = dressedCharacter(mtoon1(Json::object()));
  writer.document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      writer.accessor(std::vector<float>(32, 0.5F), "VEC4");
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_TRUE(file.look.colors.empty());
}

TEST(Mtoon1, WrongTypesBecomeDefaultsAndOneSentence) {
  const CharacterFile file = test::valueOf(parsed(dressedCharacter(mtoon1(Json::parse(R"({
    "transparentWithZWrite": "yes", "shadeColorFactor": ["red", 0, 0], "shadingToonyFactor": "0.5",
    "outlineWidthMode": "thick", "shadeMultiplyTexture": "picture.png", "uvAnimationRotationSpeedFactor": [1]})")))));
  const Material& m = file.look.materials.at(0);
  EXPECT_EQ(m.shading, Shading::kToon);
  EXPECT_EQ(m.toon.toony, 0.9F);
  EXPECT_EQ(m.toon.shadeColor, Vec3f(0, 0, 0));
  EXPECT_EQ(m.toon.outline, OutlineMode::kNone);
  EXPECT_FALSE(m.toon.shade.given());
  EXPECT_EQ(notesWith(file,
                      "material 0: transparentWithZWrite is not as expected, true or false, and 4 other members: "
                      "their defaults are used"),
            1);
  EXPECT_EQ(notesWith(file, "material 0: refers to texture -1"), 1);
  EXPECT_EQ(file.notes.size(), 2u);
}

// The conversion of UniVRM and of three-vrm: https://github.com/vrm-c/UniVRM, "MigrationMToonMaterial".
TEST(Mtoon0, EveryFieldIsConverted) {
  const CharacterFile file = test::valueOf(vrm0({Json::parse(R"({
    "name": "0", "shader": "VRM/MToon", "renderQueue": 2450,
    "floatProperties": {"_Cutoff": 0.25, "_CullMode": 0, "_BumpScale": 0.5, "_ShadeShift": -0.25, "_ShadeToony": 0.5,
      "_RimLightingMix": 0.375, "_RimFresnelPower": 4.0, "_RimLift": 0.125, "_OutlineWidthMode": 1,
      "_OutlineWidth": 0.5, "_OutlineColorMode": 1, "_OutlineLightingMix": 0.75, "_UvAnimScrollX": 0.5,
      "_UvAnimScrollY": 0.25, "_UvAnimRotation": 1.5},
    "vectorProperties": {"_Color": [0.9, 0.8, 0.7, 0.6], "_ShadeColor": [0.6, 0.5, 0.4, 1],
      "_EmissionColor": [0.1, 0.2, 0.3, 1], "_RimColor": [0.3, 0.2, 0.1, 1], "_OutlineColor": [0.4, 0.3, 0.2, 1],
      "_MainTex": [0.1, 0.2, 0.5, 0.25]},
    "textureProperties": {"_MainTex": 1, "_ShadeTexture": 2, "_BumpMap": 3, "_EmissionMap": 4, "_SphereAdd": 5,
      "_RimTexture": 6, "_OutlineWidthTexture": 7, "_UvAnimMaskTexture": 8},
    "keywordMap": {"_ALPHATEST_ON": true}, "tagMap": {"RenderType": "TransparentCutout"}})")}));
  EXPECT_EQ(notesWith(file, "material"), 0);
  const Material& m = file.look.materials.at(0);
  EXPECT_EQ(m.shading, Shading::kToon);
  expectColor(m.baseColor.head<3>(), 0.9, 0.8, 0.7);
  EXPECT_EQ(m.baseColor.w(), 0.6F) << "opacity is linear";
  EXPECT_EQ(m.alpha, AlphaMode::kMask);
  EXPECT_EQ(m.alphaCutoff, 0.25F);
  EXPECT_TRUE(m.doubleSided);
  EXPECT_EQ(m.normalScale, 0.5F);
  expectColor(m.emissive, 0.1, 0.2, 0.3);
  expectColor(m.toon.shadeColor, 0.6, 0.5, 0.4);
  expectColor(m.toon.rimColor, 0.3, 0.2, 0.1);
  expectColor(m.toon.outlineColor, 0.4, 0.3, 0.2);
  // The border: 0.x has it between -shift - (1 - toony) ... in other words these two.
  const double toony = 0.5 + (1.0 - 0.5) * (0.5 + 0.5 * -0.25);
  EXPECT_NEAR(m.toon.toony, toony, 1e-6);
  EXPECT_NEAR(m.toon.shift, 0.25 - (1.0 - toony), 1e-6);
  EXPECT_EQ(m.toon.matcapFactor, Vec3f(1, 1, 1));
  EXPECT_EQ(m.toon.rimLightingMix, 0.375F);
  EXPECT_EQ(m.toon.rimPower, 4.0F);
  EXPECT_EQ(m.toon.rimLift, 0.125F);
  EXPECT_EQ(m.toon.outline, OutlineMode::kWorld);
  EXPECT_NEAR(m.toon.outlineWidth, 0.005F, 1e-8F) << "0.x counts centimetres";
  EXPECT_EQ(m.toon.outlineLightingMix, 0.75F);
  EXPECT_EQ(m.toon.uvScroll, Eigen::Vector2f(0.5F, -0.25F)) << "v points up in 0.x";
  EXPECT_EQ(m.toon.uvRotation, 1.5F);

  // Scale and offset with v up, (0.5 u + 0.1, 0.25 v' + 0.2), so that v = 1 - v' becomes 1 - (0.25 (1 - v) + 0.2).
  for (const auto& [use, picture] : {std::pair(&m.base, 1),
                                     {&m.toon.shade, 2},
                                     {&m.normal, 3},
                                     {&m.emissiveTexture, 4},
                                     {&m.toon.rim, 6},
                                     {&m.toon.outlineWidthTexture, 7},
                                     {&m.toon.uvAnimationMask, 8}}) {
    EXPECT_EQ(pictureOf(file, *use), "picture " + std::to_string(picture));
    const Eigen::Vector2f at = use->transform * Vec3f(0.3F, 0.6F, 1.0F);
    EXPECT_NEAR(at.x(), 0.5 * 0.3 + 0.1, 1e-6);
    EXPECT_NEAR(at.y(), 1.0 - (0.25 * 0.4 + 0.2), 1e-6);
  }
  EXPECT_EQ(pictureOf(file, m.toon.matcap), "picture 5");
  EXPECT_EQ(m.toon.matcap.transform, TextureUse().transform) << "the matcap has no coordinates to move";
}

TEST(Mtoon0, DefaultsAreUnitys) {
  const Material m = onlyOf({{"shader", "VRM/MToon"}});
  EXPECT_EQ(m.shading, Shading::kToon);
  EXPECT_EQ(m.baseColor, Eigen::Vector4f(1, 1, 1, 1));
  EXPECT_EQ(m.alpha, AlphaMode::kOpaque);
  EXPECT_FALSE(m.doubleSided);
  EXPECT_EQ(m.emissive, Vec3f(0, 0, 0)) << "that of the glTF material does not count";
  expectColor(m.toon.shadeColor, 0.97, 0.81, 0.86);
  EXPECT_NEAR(m.toon.toony, 0.95F, 1e-6F);
  EXPECT_NEAR(m.toon.shift, -0.05F, 1e-6F);
  EXPECT_EQ(m.toon.matcapFactor, Vec3f(0, 0, 0));
  EXPECT_EQ(m.toon.rimPower, 1.0F);
  EXPECT_EQ(m.toon.rimLightingMix, 0.0F);
  EXPECT_EQ(m.toon.outline, OutlineMode::kNone);
  EXPECT_EQ(m.toon.outlineLightingMix, 0.0F);
  EXPECT_EQ(m.toon.giEqualization, 0.9F);
  for (const TextureUse* use : m.textures()) EXPECT_FALSE(use->given());
  const auto with = [](const Json& floats) {
    return onlyOf({{"shader", "VRM/MToon"}, {"floatProperties", floats}}).toon;
  };
  EXPECT_EQ(with({{"_IndirectLightIntensity", 0.25}}).giEqualization, 0.75F);
  EXPECT_EQ(with({{"_OutlineWidthMode", 2}}).outline, OutlineMode::kScreen);
  // A fixed colour of the outline has no light.
  EXPECT_EQ(with({{"_OutlineColorMode", 0}, {"_OutlineLightingMix", 1}}).outlineLightingMix, 0.0F);
}

TEST(Vrm0Materials, UnlitShadersAreRead) {
  const auto unlit = [](const char* shader) {
    return onlyOf({{"shader", shader},
                   {"floatProperties", {{"_Cutoff", 0.75}}},
                   {"vectorProperties", {{"_Color", {0.5, 0.25, 1, 0.5}}, {"_MainTex", {0, 0.5, 1, 0.5}}}},
                   {"textureProperties", {{"_MainTex", 2}}}});
  };
  for (const auto& [shader, alpha] : {std::pair("VRM/UnlitTexture", AlphaMode::kOpaque),
                                      {"VRM/UnlitCutout", AlphaMode::kMask},
                                      {"VRM/UnlitTransparent", AlphaMode::kBlend},
                                      {"VRM/UnlitTransparentZWrite", AlphaMode::kBlend}}) {
    SCOPED_TRACE(shader);
    const Material m = unlit(shader);
    EXPECT_EQ(m.alpha, alpha);
    EXPECT_EQ(m.shading, Shading::kUnlit);
    expectColor(m.baseColor.head<3>(), 0.5, 0.25, 1.0);
    EXPECT_EQ(m.baseColor.w(), 0.5F);
    EXPECT_TRUE(m.base.given());
    EXPECT_NEAR(m.base.transform(1, 2), 0.0F, 1e-6F);
    EXPECT_EQ(m.base.transform(1, 1), 0.5F);
    EXPECT_EQ(m.alphaCutoff, 0.75F);
  }
  EXPECT_FALSE(unlit("VRM/UnlitTransparent").blendWritesDepth);
  EXPECT_TRUE(unlit("VRM/UnlitTransparentZWrite").blendWritesDepth);
  // Other shaders leave the glTF material as it is.
  EXPECT_EQ(onlyOf({{"shader", "VRM_USE_GLTFSHADER"}}).shading, Shading::kPhysical);
  EXPECT_EQ(onlyOf({{"shader", "Standard"}}).emissive, Vec3f(1, 1, 1));
}

TEST(Vrm0Materials, OnlyTheRanksOfRenderQueuesCount) {
  const auto blended = [](int queue, bool writesDepth) {
    return Json{{"shader", "VRM/MToon"},
                {"renderQueue", queue},
                {"floatProperties", {{"_ZWrite", writesDepth ? 1 : 0}}},
                {"keywordMap", {{"_ALPHABLEND_ON", true}}}};
  };
  const Json unlit = {{"shader", "VRM/UnlitTransparent"}, {"renderQueue", 3050}};
  const Json opaque = {{"shader", "VRM/MToon"}, {"renderQueue", 9}};
  const CharacterFile file = test::valueOf(vrm0({blended(3100, false), blended(2600, true), blended(3000, false),
                                                 blended(2501, true), blended(3000, false), unlit, opaque}));
  const std::vector<Material>& m = file.look.materials;
  ASSERT_EQ(m.size(), 7u);
  EXPECT_LT(m[3].drawOrder, m[1].drawOrder);
  EXPECT_LT(m[1].drawOrder, m[2].drawOrder);
  EXPECT_EQ(m[2].drawOrder, m[4].drawOrder);
  EXPECT_LT(m[4].drawOrder, m[5].drawOrder);
  EXPECT_LT(m[5].drawOrder, m[0].drawOrder);
  EXPECT_TRUE(m[1].blendWritesDepth);
  EXPECT_FALSE(m[0].blendWritesDepth);
  EXPECT_EQ(m[0].alpha, AlphaMode::kBlend);
  EXPECT_EQ(m[6].alpha, AlphaMode::kOpaque);
}

TEST(Vrm0Materials, HostilePropertiesBecomeDefaults) {
  const CharacterFile file = test::valueOf(vrm0(Json::parse(R"([
    null, {"shader": 5},
    {"shader": "VRM/MToon", "floatProperties": "none", "vectorProperties": 7, "textureProperties": [1, 2]},
    {"shader": "VRM/MToon", "renderQueue": 1e300, "keywordMap": {"_ALPHABLEND_ON": true},
     "floatProperties": {"_Cutoff": "0.5", "_ShadeToony": [1], "_OutlineWidth": -1e30},
     "vectorProperties": {"_Color": [1, 2], "_RimColor": ["a", "b", "c"], "_MainTex": [1]},
     "textureProperties": {"_MainTex": 4294967296, "_BumpMap": -1, "_RimTexture": "x", "_SphereAdd": 99}},
    {"shader": "VRM/UnlitTransparent", "renderQueue": -1e300, "textureProperties": {"_MainTex": 1.5}}])")));
  test::expectSound(file);
  for (const Material& m : file.look.materials) {
    for (const TextureUse* use : m.textures()) EXPECT_FALSE(use->given()) << m.name;
  }
  EXPECT_EQ(notesWith(file, "material 3 '3': _MainTex is not as expected, 4 numbers, and "), 1);
  EXPECT_EQ(notesWith(file, "5 uses of textures that do not exist"), 1);
  EXPECT_EQ(file.look.materials[3].baseColor, Eigen::Vector4f(1, 1, 1, 1));
}

}  // namespace
}  // namespace lorica
