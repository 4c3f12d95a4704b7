#include "skinning/import/gltf_parts.h"

#include "skinning/import/picture_store.h"
#include "tests/skinning/import/material_samples.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>
#include <filesystem>
#include <functional>
#include <numbers>

namespace lorica {
namespace {

using test::dressedCharacter;
using test::GlbWriter;
using test::notesWith;
using test::parsed;
using test::pictureOf;
using Json = nlohmann::json;
namespace fs = std::filesystem;

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
  const CharacterFile file = test::valueOf(dressed({{"emissiveTexture", use}}));
  const TextureUse& read = file.look.materials.at(0).emissiveTexture;
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

// What of a file's materials and pictures is broken, missing or hostile.

[[nodiscard]] Json emissive(int texture = 0) {
  return {{"name", "skin"}, {"emissiveTexture", {{"index", texture}}}};
}

TEST(LookFaults, BecomePlainWithOneSentence) {
  const auto set = [](const char* pointer, const Json& value) {
    return [=](Json& d) { d[Json::json_pointer(pointer)] = value; };
  };
  const std::vector<std::pair<std::function<void(Json&)>, std::string>> faults = {
      {set("/materials", "none"), "its materials are not a list: ignored"},
      {set("/materials", {{"0", 1}}), "its materials are not a list: ignored"},
      {set("/materials/0", 5), "material 0: is not an object: it stays plain"},
      {set("/materials/0", nullptr), "material 0: is not an object: it stays plain"},
      {set("/materials/0/emissiveTexture/index", 16),
       "material 0 'skin': refers to texture 16, the file has 16: it stays plain"},
      {set("/materials/0/emissiveTexture/index", 4294967296),
       "material 0 'skin': refers to texture 4294967296, the file has 16: it stays plain"},
      {set("/materials/0/emissiveTexture", "skin.png"),
       "material 0 'skin': refers to texture -1, the file has 16: it stays plain"},
      {set("/textures", 3),
       "its textures are not a list: ignored | material 0 'skin': refers to texture 0, the file has 0: it stays plain"},
      {set("/textures/0/source", 99), "texture 0: refers to image 99, the file has 16: its materials stay plain"},
      {set("/textures/0/source", "0"), "texture 0: refers to image \"0\", the file has 16: its materials stay plain"},
      {set("/textures/0", Json::object()), "texture 0: has no picture: its materials stay plain"},
      {set("/textures/0", {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}),
       "texture 0: KHR_texture_basisu is not supported, expected PNG, JPEG or WebP: its materials stay plain"},
      {set("/textures/0", {{"extensions", {{"EXT_texture_avif", {{"source", 0}}}}}}),
       "texture 0: EXT_texture_avif is not supported, expected PNG, JPEG or WebP: its materials stay plain"},
      {set("/images/0", {{"name", "hair"}}),
       "image 0 'hair': has neither a bufferView that exists nor a uri: its materials stay plain"},
      {set("/images/0", nullptr), "image 0: has neither a bufferView that exists nor a uri: its materials stay plain"},
      {set("/images/0/bufferView", 4711),
       "image 0: has neither a bufferView that exists nor a uri: its materials stay plain"},
      {[](Json& d) {
         d["images"][0]["bufferView"] = d["bufferViews"].size();
         d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 100}, {"byteLength", 1000000}});
       },
       "image 0: buffer view 25: 1,000,000 bytes from byte 100, but buffer 0 has 814: its materials stay plain"},
      {[](Json& d) {
         d["images"][0]["bufferView"] = d["bufferViews"].size();
         d["bufferViews"].push_back({{"buffer", 3}, {"byteLength", 8}});
       },
       "image 0: refers to buffer 3, which does not exist: its materials stay plain"},
      {set("/images/0", {{"uri", "data:image/png;base64,AA!A"}}),
       "image 0: its data URI has byte 33 at 2, expected base64: its materials stay plain"},
      {set("/images/0", {{"uri", "skin.png"}}),
       "image 0: is in another file, 'skin.png', which is not available here: its materials stay plain"},
      {set("/images/0", {{"uri", "../skin.png"}}),
       "image 0: '../skin.png' is outside the file's folder, expected a file in it (or --trust-paths): its materials "
       "stay plain"},
      {set("/images/0", {{"uri", "http://example.org/skin.png"}}),
       "image 0: 'http://example.org/skin.png' is outside the file's folder, expected a file in it (or --trust-paths): "
       "its materials stay plain"},
      {set("/materials/0", {{"name", 5},
                            {"pbrMetallicRoughness", "x"},
                            {"alphaMode", 1},
                            {"alphaCutoff", "0"},
                            {"doubleSided", "yes"},
                            {"emissiveFactor", {1, "b", 2}},
                            {"extensions", 4}}),
       "material 0: emissiveFactor is not as expected, 3 numbers, and 3 other members: their defaults are used"}};
  for (const auto& [breakIt, notes] : faults) {
    SCOPED_TRACE(notes);
    GlbWriter writer = dressedCharacter(emissive());
    breakIt(writer.document);
    const CharacterFile file = test::valueOf(parsed(writer));
    test::expectSound(file);
    EXPECT_EQ(file.character.mesh.triangles.size(), 12u);
    EXPECT_EQ(fmt::format("{}", fmt::join(file.notes, " | ")), notes);
    for (const Material& m : file.look.materials) EXPECT_FALSE(m.emissiveTexture.given());
  }
}

TEST(PictureStore, AHugeCoordinateSetIsTheFirst) {
  for (const Json& set : {Json(1e30), Json(2), Json(-1), Json(4294967297)}) {
    Json material = emissive();
    material["emissiveTexture"]["texCoord"] = set;
    const CharacterFile file = test::valueOf(parsed(dressedCharacter(material)));
    test::expectSound(file);
    EXPECT_EQ(file.look.materials[0].emissiveTexture.uvSet, 0);
    EXPECT_EQ(notesWith(file, "a third or later set of coordinates"), 1) << set;
  }
}

TEST(PictureStore, SamplersThatAreBrokenAreTheDefault) {
  for (const Json& samplers : {Json("none"), Json({1}), Json({{{"wrapS", "x"}, {"magFilter", {1}}}}), Json::array()}) {
    GlbWriter writer = dressedCharacter(emissive());
    writer.document["samplers"] = samplers;
    writer.document["textures"][0]["sampler"] = 0;
    const CharacterFile file = test::valueOf(parsed(writer));
    const TextureUse& use = file.look.materials[0].emissiveTexture;
    EXPECT_TRUE(use.given());
    EXPECT_EQ(use.wrapU, TextureWrap::kRepeat);
    EXPECT_TRUE(use.smooth);
  }
}

TEST(PictureStore, PicturesBesideTheFileAndInDataUrisAreRead) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "tex");
  (void)folder.write("tex/the skin.png", "bytes of the skin");
  for (const std::string& uri :
       std::initializer_list<std::string>{"tex/the%20skin.png", "./tex/the skin.png", "tex\\the skin.png",
                                          "data:image/png;base64," + test::base64("bytes of the skin")}) {
    GlbWriter writer = dressedCharacter(emissive());
    writer.document["images"][0] = {{"uri", uri}, {"name", "skin"}};
    const CharacterFile file = test::valueOf(readCharacterFile(folder.write("hero.glb", writer.glb())));
    EXPECT_TRUE(file.notes.empty()) << file.notes.front();
    EXPECT_EQ(pictureOf(file, file.look.materials[0].emissiveTexture), "bytes of the skin");
    EXPECT_EQ(file.look.pictures[0].name, "image 0 'skin'");
  }
}

TEST(PictureStore, NothingOutsideTheFolderIsRead) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "inside");
  const fs::path outside = folder.write("secret.png", "secret");
  for (const std::string& uri : std::initializer_list<std::string>{
           "../secret.png", "%2e%2e/secret.png", "..\\secret.png", "x/../../secret.png", outside.string(),
           "file://" + outside.string(), "~/secret.png", "C:/secret.png", "nowhere.png", "."}) {
    SCOPED_TRACE(uri);
    GlbWriter writer = dressedCharacter(emissive());
    writer.document["images"][0] = {{"uri", uri}};
    const CharacterFile file = test::valueOf(readCharacterFile(folder.write("inside/hero.glb", writer.glb())));
    EXPECT_TRUE(file.look.pictures.empty());
    EXPECT_EQ(notesWith(file, "image 0: '"), 1);
    EXPECT_EQ(notesWith(file, uri == "nowhere.png" || uri == "." ? "is not a file in the character's folder"
                                                                 : "is outside the file's folder"),
              1);
  }
}

/// A character with `count` materials, textures and images.
[[nodiscard]] GlbWriter manyPictures(int count, const std::function<Json(int)>& image) {
  GlbWriter writer = dressedCharacter(emissive());
  Json& d = writer.document;
  const Json like = d["meshes"][0]["primitives"][0];
  for (const char* list : {"images", "textures", "materials"}) d[list] = Json::array();
  d["meshes"][0]["primitives"] = Json::array();
  for (int i = 0; i < count; ++i) {
    d["images"].push_back(image(i));
    d["textures"].push_back({{"source", i}});
    d["materials"].push_back(emissive(i));
    d["meshes"][0]["primitives"].push_back(like);
    d["meshes"][0]["primitives"][i]["material"] = i;
  }
  return writer;
}

[[nodiscard]] std::size_t pictureBytes(const CharacterFile& file) {
  std::size_t bytes = 0;
  for (const StoredPicture& picture : file.look.pictures) bytes += picture.bytes.size();
  return bytes;
}

TEST(PictureStore, PicturesThatShareBytesHaveTwiceTheFilesAtMost) {
  // All images are the same 200 kB under another number.
  GlbWriter writer = manyPictures(2000, [](int) { return Json{{"bufferView", 25}}; });
  EXPECT_EQ(writer.view(std::vector<char>(200'000, 'x')), 25);
  const CharacterFile file = test::valueOf(parsed(writer));
  test::expectSound(file);
  EXPECT_GE(file.look.pictures.size(), 2u);
  EXPECT_LE(pictureBytes(file), 2 * writer.glb().size());
  EXPECT_EQ(notesWith(file, "all pictures together have more than twice the bytes of the file"), 1);
  EXPECT_EQ(file.notes.size(), 1u) << "one sentence for all of them";
}

TEST(PictureStore, OneFileUnderManyNamesIsReadOnce) {
  const test::TemporaryFolder folder;
  (void)folder.write("skin.png", std::string(100'000, 'x'));
  GlbWriter writer = manyPictures(50, [](int i) {
    std::string uri;
    for (int k = 0; k < i; ++k) uri += "./";
    return Json{{"uri", uri + (i % 2 == 0 ? "skin.png" : "%73kin.png")}};
  });
  const CharacterFile file = test::valueOf(readCharacterFile(folder.write("hero.glb", writer.glb())));
  EXPECT_EQ(file.look.pictures.size(), 1u);
  EXPECT_TRUE(file.notes.empty());
}

TEST(PictureStore, AThousandBrokenPicturesAreOneSentence) {
  const Result<CharacterFile> file = parsed(manyPictures(1000, [](int i) {
    return Json{{"uri", "../skin" + std::to_string(i) + ".png"}};
  }));
  ASSERT_TRUE(file.ok()) << file.error().message;
  ASSERT_EQ(file->notes.size(), 1u);
  EXPECT_EQ(
      file->notes[0],
      "1,000 pictures are not available, their materials stay plain; the first: image 0: '../skin0.png' is outside "
      "the file's folder, expected a file in it (or --trust-paths): its materials stay plain");
}

}  // namespace
}  // namespace lorica
