#include "skinning/import/gltf_materials.h"

#include "tests/skinning/import/material_samples.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <complex>
#include <filesystem>
#include <numbers>

namespace lorica {
namespace {

using test::dressedCharacter;
using test::GlbWriter;
using test::notesWith;
using test::parsed;
using test::pictureOf;
using Json = nlohmann::json;

[[nodiscard]] Result<CharacterFile> dressed(const Json& material) {
  return parsed(dressedCharacter(material));
}

TEST(GltfMaterials, EveryFieldIsRead) {
  const CharacterFile file = test::valueOf(dressed(Json::parse(R"({
    "name": "skin", "pbrMetallicRoughness": {"baseColorFactor": [0.125, 0.25, 0.5, 0.75],
      "baseColorTexture": {"index": 1}, "metallicFactor": 0.25, "roughnessFactor": 0.375,
      "metallicRoughnessTexture": {"index": 2, "texCoord": 1}},
    "normalTexture": {"index": 3, "scale": 0.5},
    "occlusionTexture": {"index": 4, "texCoord": 1, "strength": 0.625},
    "emissiveTexture": {"index": 5}, "emissiveFactor": [0.25, 0.5, 1.0], "alphaMode": "MASK", "alphaCutoff": 0.875,
    "doubleSided": true, "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0},
      "KHR_materials_unlit": {}}})")));
  EXPECT_TRUE(file.notes.empty()) << file.notes.front();
  test::expectSound(file);
  ASSERT_EQ(file.look.materials.size(), 1u);
  const Material& m = file.look.materials[0];
  EXPECT_EQ(m.name, "skin");
  EXPECT_EQ(m.shading, Shading::kUnlit);
  EXPECT_EQ(m.baseColor, Eigen::Vector4f(0.125F, 0.25F, 0.5F, 0.75F));
  EXPECT_EQ(pictureOf(file, m.base), "picture 1");
  EXPECT_EQ(m.metallic, 0.25F);
  EXPECT_EQ(m.roughness, 0.375F);
  EXPECT_EQ(pictureOf(file, m.metallicRoughness), "picture 2");
  EXPECT_EQ(m.metallicRoughness.uvSet, 1);
  EXPECT_EQ(pictureOf(file, m.normal), "picture 3");
  EXPECT_EQ(m.normalScale, 0.5F);
  EXPECT_EQ(pictureOf(file, m.occlusion), "picture 4");
  EXPECT_EQ(m.occlusion.uvSet, 1);
  EXPECT_EQ(m.occlusionStrength, 0.625F);
  EXPECT_EQ(pictureOf(file, m.emissiveTexture), "picture 5");
  EXPECT_EQ(m.emissive, Vec3f(0.25F, 0.5F, 1.0F));
  EXPECT_EQ(m.emissiveStrength, 4.0F);
  EXPECT_EQ(m.alpha, AlphaMode::kMask);
  EXPECT_EQ(m.alphaCutoff, 0.875F);
  EXPECT_TRUE(m.doubleSided);
  // Of the 16 pictures, those that are used.
  EXPECT_EQ(file.look.pictures.size(), 5u);
  EXPECT_EQ(file.look.pictures[0].name, "image 1");
}

TEST(GltfMaterials, AnEmptyMaterialHasTheDefaultsOfGltf) {
  const CharacterFile file = test::valueOf(dressed(Json::object()));
  const Material& m = file.look.materials.at(0);
  EXPECT_EQ(m.name, "material 0");
  EXPECT_EQ(m.shading, Shading::kPhysical);
  EXPECT_EQ(m.baseColor, Eigen::Vector4f(1, 1, 1, 1));
  EXPECT_EQ(m.metallic, 1.0F);
  EXPECT_EQ(m.roughness, 1.0F);
  EXPECT_EQ(m.emissive, Vec3f(0, 0, 0));
  EXPECT_EQ(m.alpha, AlphaMode::kOpaque);
  EXPECT_EQ(m.alphaCutoff, 0.5F);
  EXPECT_FALSE(m.doubleSided);
  for (const TextureUse* use : m.textures()) EXPECT_FALSE(use->given());
  EXPECT_EQ(dressed({{"alphaMode", "BLEND"}})->look.materials.at(0).alpha, AlphaMode::kBlend);
}

TEST(GltfMaterials, SamplersGiveWrapAndFilter) {
  GlbWriter writer = dressedCharacter({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                       {"normalTexture", {{"index", 1}}},
                                       {"emissiveTexture", {{"index", 2}}}});
  writer.document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}},
                                 {{"wrapS", 10497}, {"wrapT", 33071}, {"magFilter", 9729}}};
  writer.document["textures"][0]["sampler"] = 0;
  writer.document["textures"][1]["sampler"] = 1;
  const CharacterFile file = test::valueOf(parsed(writer));
  const Material& m = file.look.materials.at(0);
  EXPECT_EQ(m.base.wrapU, TextureWrap::kClamp);
  EXPECT_EQ(m.base.wrapV, TextureWrap::kMirror);
  EXPECT_FALSE(m.base.smooth);
  EXPECT_EQ(m.normal.wrapU, TextureWrap::kRepeat);
  EXPECT_EQ(m.normal.wrapV, TextureWrap::kClamp);
  EXPECT_TRUE(m.normal.smooth);
  EXPECT_EQ(m.emissiveTexture.wrapU, TextureWrap::kRepeat);
  EXPECT_EQ(m.emissiveTexture.wrapV, TextureWrap::kRepeat);
}

[[nodiscard]] Eigen::Matrix<float, 2, 3> transformOf(const Json& transform, int* uvSet = nullptr) {
  const Json use = {{"index", 0}, {"texCoord", 0}, {"extensions", {{"KHR_texture_transform", transform}}}};
  const Result<CharacterFile> file = dressed({{"emissiveTexture", use}});
  EXPECT_TRUE(file.ok());
  const TextureUse& read = file->look.materials.at(0).emissiveTexture;
  if (uvSet != nullptr) *uvSet = read.uvSet;
  return read.transform;
}

// https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_texture_transform
TEST(GltfMaterials, TextureTransformsScaleThenTurnThenMove) {
  EXPECT_EQ(transformOf(Json::object()), TextureUse().transform);
  EXPECT_TRUE(transformOf({{"offset", {0.25, -2.0}}})
                  .isApprox((Eigen::Matrix<float, 2, 3>() << 1, 0, 0.25F, 0, 1, -2).finished()));
  // The extension's second example inverts v.
  EXPECT_TRUE(transformOf({{"offset", {0, 1}}, {"scale", {1, -1}}})
                  .isApprox((Eigen::Matrix<float, 2, 3>() << 1, 0, 0, 0, -1, 1).finished()));
  // Its first example: the lower left quarter of the picture. With v down these are u below 0.5 and v above it.
  const Eigen::Matrix<float, 2, 3> quarter =
      transformOf({{"offset", {0, 1}}, {"rotation", 0.5 * std::numbers::pi}, {"scale", {0.5, 0.5}}});
  for (const Vec3f& corner : {Vec3f(0, 0, 1), Vec3f(1, 0, 1), Vec3f(0, 1, 1), Vec3f(1, 1, 1)}) {
    const Eigen::Vector2f at = quarter * corner;
    EXPECT_NEAR(at.x(), corner.y() < 0.5F ? 0.0 : 0.5, 1e-6);
    EXPECT_NEAR(at.y(), corner.x() < 0.5F ? 1.0 : 0.5, 1e-6);
  }
  // Any angle, with complex numbers: coordinates turn counter-clockwise as seen with v down.
  for (const double angle : {0.3, -1.1, 2.9}) {
    const Eigen::Matrix<float, 2, 3> matrix =
        transformOf({{"offset", {0.1, 0.2}}, {"rotation", angle}, {"scale", {2.0, 0.5}}});
    const std::complex<double> scaled(2.0 * 0.3, -0.5 * 0.7);  // of (0.3, 0.7), with v up
    const std::complex<double> turned = scaled * std::polar(1.0, angle);
    const Eigen::Vector2f at = matrix * Vec3f(0.3F, 0.7F, 1.0F);
    EXPECT_NEAR(at.x(), turned.real() + 0.1, 1e-6);
    EXPECT_NEAR(at.y(), -turned.imag() + 0.2, 1e-6);
  }
  int uvSet = 0;
  (void)transformOf({{"texCoord", 1}}, &uvSet);
  EXPECT_EQ(uvSet, 1);
}

TEST(GltfMaterials, OnlyWhatMaterialsUseIsRead) {
  const CharacterFile plain = test::valueOf(dressed({{"name", "plain"}}));
  EXPECT_TRUE(plain.look.uv[0].empty());
  EXPECT_TRUE(plain.look.uv[1].empty());
  EXPECT_TRUE(plain.look.pictures.empty());

  const CharacterFile second = test::valueOf(dressed({{"emissiveTexture", {{"index", 0}, {"texCoord", 1}}}}));
  EXPECT_TRUE(second.look.uv[0].empty());
  ASSERT_EQ(second.look.uv[1].size(), 8u);
  for (std::size_t v = 0; v < 8; ++v) {
    const auto number = static_cast<float>(v);
    EXPECT_EQ(second.look.uv[1][v], Eigen::Vector2f(0.125F * number, 0.5F + 0.0625F * number));
  }

  // Without materials there is no look.
  const CharacterFile bare = test::valueOf(parsed(test::smallCharacter()));
  EXPECT_FALSE(bare.look.given());

  // Materials that no mesh uses keep their places, since expressions refer to them, but not their pictures.
  GlbWriter writer = dressedCharacter({{"name", "unused"}, {"normalTexture", {{"index", 3}}}});
  writer.document["materials"].push_back({{"name", "used"}});
  writer.document["meshes"][0]["primitives"][0]["material"] = 1;
  const CharacterFile file = test::valueOf(parsed(writer));
  ASSERT_EQ(file.look.materials.size(), 2u);
  EXPECT_EQ(file.look.materials[0].name, "unused");
  EXPECT_TRUE(file.look.pictures.empty());
  EXPECT_EQ(file.look.groups.at(0).material, 1);
}

TEST(GltfMaterials, TexturesThatShareAPictureShareIt) {
  GlbWriter writer = dressedCharacter({{"normalTexture", {{"index", 1}}}, {"emissiveTexture", {{"index", 2}}}});
  writer.document["textures"][2]["source"] = 1;
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.look.pictures.size(), 1u);
  EXPECT_EQ(file.look.materials[0].normal.picture, file.look.materials[0].emissiveTexture.picture);
}

TEST(GltfMaterials, MeshesWithoutOneGetAPlainOneOfTheirOwn) {
  GlbWriter writer = dressedCharacter({{"name", "only"}});
  Json second = writer.document["meshes"][0]["primitives"][0];
  second.erase("material");
  Json third = second;
  third["material"] = 77;
  writer.document["meshes"][0]["primitives"].push_back(second);
  writer.document["meshes"][0]["primitives"].push_back(third);
  const CharacterFile file = test::valueOf(parsed(writer));
  test::expectSound(file);
  ASSERT_EQ(file.look.groups.size(), 3u);
  ASSERT_EQ(file.look.materials.size(), 2u);
  EXPECT_EQ(file.look.materials[1].name, "(none)");
  EXPECT_EQ(file.look.groups[1].material, 1);
  EXPECT_EQ(file.look.groups[2].material, 1);
  EXPECT_EQ(notesWith(file, "mesh 'Body': refers to material 77, the file has 1"), 1);
}

TEST(GltfMaterials, SharedCharactersHaveSoundLooks) {
  int seen = 0;
  for (const char* name :
       {"arnaud/arnaud.fbx", "cesiumman/CesiumMan.glb", "fox/Fox.glb", "godette/Godette_vrm_v4.vrm",
        "greenman/greenman.glb", "kaykit/Barbarian.glb", "kaykit/Mage.glb", "raylib_robot/robot.glb"}) {
    const std::filesystem::path path = test::dataset(std::string("characters/") + name);
    if (path.empty()) continue;
    SCOPED_TRACE(name);
    ++seen;
    const CharacterFile file = test::valueOf(readCharacterFile(path));
    EXPECT_TRUE(file.look.given());
    test::expectSound(file);
    EXPECT_EQ(notesWith(file, "plain"), 0);
  }
  if (seen == 0) GTEST_SKIP() << "the shared characters are absent: pass -DLORICA_DATASETS=<folder> to CMake";
}

}  // namespace
}  // namespace lorica
