#include "skinning/import/assimp_parts.h"

#include "tests/skinning/import/material_samples.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace lorica {
namespace {

using test::notesWith;
using test::pictureOf;
namespace fs = std::filesystem;

/// One triangle in a text FBX file, smooth, with coordinates (0.25, 0.125), (0.5, 0.25), (0.75, 1), a colour for each
/// vertex, this material and this texture as its diffuse colour.
struct FbxText {
  std::string material;                   ///< properties
  std::string texture;                    ///< properties
  std::string picture = "skin.png";       ///< as the file names it
  std::string video;                      ///< "Content" of the picture inside the file, or nothing
  std::string property = "DiffuseColor";  ///< of the material, that the texture replaces

  [[nodiscard]] std::string text() const {
    const bool textured = !picture.empty();
    const auto layer = [](const std::string& kind, const std::string& mapping, const std::string& reference,
                          const std::string& content) {
      return "  LayerElement" + kind + ": 0 {\n   Version: 101\n   Name: \"\"\n   MappingInformationType: \"" +
             mapping + "\"\n   ReferenceInformationType: \"" + reference + "\"\n   " + content + "\n  }\n";
    };
    const auto use = [](const std::string& kind) {
      return "   LayerElement:  {\n    Type: \"LayerElement" + kind + "\"\n    TypedIndex: 0\n   }\n";
    };
    std::string t =
        "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n FBXHeaderVersion: 1003\n FBXVersion: 7300\n}\n"
        "GlobalSettings:  {\n Version: 1000\n Properties70:  {\n }\n}\nObjects:  {\n"
        " Geometry: 100, \"Geometry::\", \"Mesh\" {\n"
        "  Vertices: *9 {\n   a: 0,0,0,100,0,0,0,100,0\n  }\n"
        "  PolygonVertexIndex: *3 {\n   a: 0,1,-3\n  }\n" +
        layer("Normal", "ByPolygonVertex", "Direct", "Normals: *9 {\n    a: 0,0,1,0,0,1,0,0,1\n   }") +
        layer("Color", "ByPolygonVertex", "Direct", "Colors: *12 {\n    a: 1,0,0.5,1,1,0,0.5,1,1,0,0.5,1\n   }") +
        layer("UV", "ByPolygonVertex", "Direct", "UV: *6 {\n    a: 0.25,0.125,0.5,0.25,0.75,1\n   }") +
        layer("Material", "AllSame", "IndexToDirect", "Materials: *1 {\n    a: 0\n   }") +
        "  Layer: 0 {\n   Version: 100\n" + use("Normal") + use("Color") + use("UV") + use("Material") +
        "  }\n }\n"
        " Model: 200, \"Model::Tri\", \"Mesh\" {\n  Version: 232\n }\n"
        " Material: 300, \"Material::skin\", \"\" {\n  Version: 102\n  ShadingModel: \"phong\"\n"
        "  Properties70:  {\n" +
        material + "  }\n }\n";
    if (textured) {
      t += " Texture: 400, \"Texture::t\", \"\" {\n  Type: \"TextureVideoClip\"\n  Version: 202\n"
           "  TextureName: \"Texture::t\"\n  Media: \"Video::v\"\n  FileName: \"C:\\\\art\\\\" +
           picture + "\"\n  RelativeFilename: \"" + picture + "\"\n" + texture + " }\n";
      t += " Video: 500, \"Video::v\", \"Clip\" {\n  Type: \"Clip\"\n  FileName: \"" + picture +
           "\"\n  RelativeFilename: \"" + picture + "\"\n" +
           (video.empty() ? "" : "  Content: ,\n   \"" + video + "\"\n") + " }\n";
    }
    t += "}\nConnections:  {\n C: \"OO\",200,0\n C: \"OO\",100,200\n C: \"OO\",300,200\n";
    if (textured) t += " C: \"OP\",400,300, \"" + property + "\"\n C: \"OO\",500,400\n";
    return t + "}\n";
  }

  [[nodiscard]] Result<CharacterFile> read() const {
    const std::string bytes = text();
    return parseCharacterFile(std::as_bytes(std::span(bytes)), "t.fbx");
  }
};

[[nodiscard]] std::string color(const char* name, double r, double g, double b) {
  return fmt::format("   P: \"{}\", \"Color\", \"\", \"A\",{},{},{}\n", name, r, g, b);
}

[[nodiscard]] std::string number(const char* name, double value) {
  return fmt::format("   P: \"{}\", \"Number\", \"\", \"A\",{}\n", name, value);
}

/// IEC 61966-2-1.
[[nodiscard]] float linear(double c) {
  return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

TEST(FbxMaterials, PhongBecomesMetallicRoughness) {
  FbxText fbx;
  fbx.picture.clear();
  fbx.material = color("DiffuseColor", 0.5, 0.25, 0.75) + color("EmissiveColor", 0.1, 0.2, 0.3) +
                 color("SpecularColor", 0.5, 0.25, 0.25) + number("ShininessExponent", 30) + number("Opacity", 0.5);
  const CharacterFile file = test::valueOf(fbx.read());
  test::expectSound(file);
  ASSERT_EQ(file.look.materials.size(), 1u);
  const Material& m = file.look.materials[0];
  EXPECT_EQ(m.name, "skin");
  EXPECT_NEAR(m.baseColor.x(), linear(0.5), 1e-6);
  EXPECT_NEAR(m.baseColor.y(), linear(0.25), 1e-6);
  EXPECT_NEAR(m.baseColor.z(), linear(0.75), 1e-6);
  EXPECT_EQ(m.baseColor.w(), 0.5F);
  EXPECT_EQ(m.alpha, AlphaMode::kBlend);
  EXPECT_NEAR(m.emissive.y(), linear(0.2), 1e-6);
  EXPECT_EQ(m.metallic, 0.0F);
  EXPECT_NEAR(m.roughness, 1.0 - 0.5 * (1.0 - std::pow(2.0 / 32.0, 0.25)), 1e-6);
  EXPECT_FALSE(m.doubleSided);

  // Without a specular colour the surface is matt.
  FbxText lambert;
  lambert.picture.clear();
  lambert.material = color("DiffuseColor", 0.5, 0.5, 0.5);
  EXPECT_EQ(lambert.read()->look.materials.at(0).roughness, 1.0F);
}

TEST(FbxMaterials, NormalsCoordinatesAndColorsAreReadWithVDown) {
  FbxText fbx;
  fbx.video = test::base64("not decoded here");
  const CharacterFile file = test::valueOf(fbx.read());
  test::expectSound(file);
  EXPECT_FALSE(file.look.groups.at(0).flat);
  ASSERT_EQ(file.look.uv[0].size(), 3u);
  EXPECT_EQ(file.look.uv[0][0], Eigen::Vector2f(0.25F, 0.875F));
  EXPECT_EQ(file.look.uv[0][1], Eigen::Vector2f(0.5F, 0.75F));
  EXPECT_EQ(file.look.uv[0][2], Eigen::Vector2f(0.75F, 0.0F));
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_NEAR((file.look.normals[v] - Vec3f(0, 0, 1)).norm(), 0.0F, 1e-6F);
    EXPECT_NEAR((file.look.colors[v] - Eigen::Vector4f(1, 0, linear(0.5), 1)).norm(), 0.0F, 1e-6F);
  }
}

TEST(FbxMaterials, PicturesInsideTheFileAreRead) {
  FbxText fbx;
  fbx.material = color("DiffuseColor", 0.5, 0.5, 0.5);
  fbx.video = test::base64("the skin");
  const CharacterFile file = test::valueOf(fbx.read());
  const Material& m = file.look.materials.at(0);
  EXPECT_EQ(pictureOf(file, m.base), "the skin");
  EXPECT_EQ(file.look.pictures[0].name, "picture 'skin.png'");
  EXPECT_EQ(m.baseColor, Eigen::Vector4f(1, 1, 1, 1)) << "the texture replaces the colour";
  EXPECT_EQ(m.base.transform, TextureUse().transform);
}

TEST(FbxMaterials, PicturesAreFoundBesideTheFileWhateverFolderItNames) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder.path() / "inside" / "tex");
  (void)folder.write("secret.png", "secret");
  (void)folder.write("inside/skin.png", "beside");
  (void)folder.write("inside/tex/skin.png", "below");
  const auto read = [&](const std::string& picture) {
    FbxText fbx;
    fbx.picture = picture;
    return readCharacterFile(folder.write("inside/t.fbx", fbx.text()));
  };
  const auto found = [&](const std::string& picture) {
    const Result<CharacterFile> file = read(picture);
    EXPECT_TRUE(file.ok());
    return pictureOf(*file, file->look.materials.at(0).base);
  };
  EXPECT_EQ(found("skin.png"), "beside");
  EXPECT_EQ(found("tex\\skin.png"), "below");
  EXPECT_EQ(found("C:\\Users\\me\\art\\skin.png"), "beside");
  EXPECT_EQ(notesWith(*read("C:\\Users\\me\\art\\skin.png"), "'skin.png' beside it is used"), 1);
  EXPECT_EQ(notesWith(*read("skin.png"), "picture"), 0);
  for (const char* outside : {"../secret.png", "..\\..\\secret.png", "nowhere.png", "..", "D:\\.."}) {
    SCOPED_TRACE(outside);
    EXPECT_EQ(found(outside), "");
    EXPECT_EQ(notesWith(*read(outside), "its materials stay plain"), 1);
  }
}

TEST(FbxMaterials, TextureTransformsAreThoseOfTheFileWithVUp) {
  FbxText fbx;
  fbx.video = test::base64("x");
  fbx.texture = "  ModelUVTranslation: 0.1,0.2\n  ModelUVScaling: 2,0.5\n";
  const CharacterFile file = test::valueOf(fbx.read());
  // The file's point (0.3, 0.6) is (0.3, 0.4) with v down.
  const Eigen::Vector2f at = file.look.materials.at(0).base.transform * Vec3f(0.3F, 0.4F, 1.0F);
  EXPECT_NEAR(at.x(), 2.0 * 0.3 + 0.1, 1e-6);
  EXPECT_NEAR(at.y(), 1.0 - (0.5 * 0.6 + 0.2), 1e-6);
}

TEST(FbxMaterials, NormalMapsAreReadAndOpacityOnlyFromTheSamePicture) {
  FbxText fbx;
  fbx.video = test::base64("bumps");
  fbx.property = "NormalMap";
  const CharacterFile normal = test::valueOf(fbx.read());
  EXPECT_EQ(pictureOf(normal, normal.look.materials.at(0).normal), "bumps");
  fbx.property = "TransparentColor";
  const CharacterFile opacity = test::valueOf(fbx.read());
  EXPECT_EQ(opacity.look.materials.at(0).alpha, AlphaMode::kOpaque);
  EXPECT_EQ(notesWith(opacity, "its opacity is in another picture than its colour: not read"), 1);
}

TEST(FbxMaterials, InvisibleMaterialsAreDrawnOpaque) {
  FbxText fbx;
  fbx.picture.clear();
  fbx.material = number("Opacity", 0);
  const CharacterFile file = test::valueOf(fbx.read());
  EXPECT_EQ(file.look.materials.at(0).alpha, AlphaMode::kOpaque);
  EXPECT_EQ(file.look.materials.at(0).baseColor.w(), 1.0F);
  EXPECT_EQ(notesWith(file, "its opacity is 0: drawn opaque"), 1);
}

/// One triangle in COLLADA; `technique` is the effect's, with a sampler "s" of the picture.
[[nodiscard]] std::string colladaText(
    const std::string& technique, const std::string& picture,
    const std::string& material = "<instance_material symbol=\"m\" target=\"#mat\"/>") {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_images><image id="img" name="img"><init_from>)" +
         picture + R"(</init_from></image></library_images>
<library_effects><effect id="fx"><profile_COMMON>
 <newparam sid="surf"><surface type="2D"><init_from>img</init_from></surface></newparam>
 <newparam sid="s"><sampler2D><source>surf</source></sampler2D></newparam>
 <technique sid="common">)" +
         technique + R"(</technique></profile_COMMON></effect></library_effects>
<library_materials><material id="mat" name="Cloth"><instance_effect url="#fx"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
 <source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
  <technique_common><accessor source="#pa" count="3" stride="3">
   <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
 <source id="t"><float_array id="ta" count="6">0 0.25 1 0.25 0 1</float_array>
  <technique_common><accessor source="#ta" count="3" stride="2">
   <param name="S" type="float"/><param name="T" type="float"/></accessor></technique_common></source>
 <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
 <triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
  <input semantic="TEXCOORD" source="#t" offset="1" set="0"/><p>0 0 1 1 2 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="sc"><node id="n" name="body"><instance_geometry url="#g"><bind_material><technique_common>)" +
         material +
         R"(</technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#sc"/></scene>
</COLLADA>)";
}

TEST(ColladaMaterials, TexturesWrapAndShadingAreRead) {
  const test::TemporaryFolder folder;
  (void)folder.write("the cloth.png", "cloth");
  const std::string technique =
      R"(<phong><emission><color>0 0 0 1</color></emission><diffuse><texture texture="s" texcoord="UV0"><extra>
<technique profile="MAYA"><wrapU>1</wrapU><wrapV>0</wrapV><mirrorU>1</mirrorU><repeatU>2</repeatU><offsetV>0.25</offsetV></technique>
</extra></texture></diffuse><specular><color>0.25 0.5 0.25 1</color></specular><shininess><float>6</float></shininess></phong>
<extra><technique profile="GOOGLEEARTH"><double_sided>1</double_sided></technique></extra>)";
  const CharacterFile file =
      test::valueOf(readCharacterFile(folder.write("t.dae", colladaText(technique, "the%20cloth.png"))));
  test::expectSound(file);
  EXPECT_EQ(notesWith(file, "picture"), 0);
  ASSERT_TRUE(file.look.given());
  const Material& m = file.look.materials.at(static_cast<std::size_t>(file.look.groups.at(0).material));
  EXPECT_EQ(m.name, "Cloth");
  EXPECT_EQ(pictureOf(file, m.base), "cloth");
  EXPECT_EQ(m.baseColor, Eigen::Vector4f(1, 1, 1, 1));
  EXPECT_EQ(m.base.wrapU, TextureWrap::kMirror);
  EXPECT_EQ(m.base.wrapV, TextureWrap::kClamp);
  EXPECT_TRUE(m.doubleSided);
  EXPECT_NEAR(m.roughness, 1.0 - 0.5 * (1.0 - std::pow(2.0 / 8.0, 0.25)), 1e-6);
  const Eigen::Vector2f at = m.base.transform * Vec3f(0.3F, 0.4F, 1.0F);
  EXPECT_NEAR(at.x(), 0.6, 1e-6);
  EXPECT_NEAR(at.y(), 1.0 - (0.6 + 0.25), 1e-6);
  ASSERT_EQ(file.look.uv[0].size(), 3u);
  EXPECT_EQ(file.look.uv[0][0], Eigen::Vector2f(0.0F, 0.75F));
  EXPECT_TRUE(file.look.groups[0].flat) << "the file has no normals";
}

TEST(ColladaMaterials, ConstantShadingIsUnlit) {
  const std::string text =
      colladaText("<constant><emission><color>0.5 0.25 1 1</color></emission></constant>", "x.png");
  const CharacterFile file = test::valueOf(parseCharacterFile(std::as_bytes(std::span(text)), "t.dae"));
  const Material& m = file.look.materials.at(0);
  EXPECT_EQ(m.shading, Shading::kUnlit);
  EXPECT_NEAR(m.baseColor.x(), linear(0.5), 1e-6);
  EXPECT_EQ(m.emissive, Vec3f(0, 0, 0));
  EXPECT_TRUE(file.look.pictures.empty()) << "no material uses it";
}

TEST(ColladaMaterials, FilesWithoutMaterialsHaveNoLook) {
  std::string text = colladaText("<lambert/>", "x.png", "");
  const std::size_t from = text.find("<library_materials>");
  text.erase(from, text.find("<library_geometries>") - from);
  const CharacterFile file = test::valueOf(parseCharacterFile(std::as_bytes(std::span(text)), "t.dae"));
  EXPECT_FALSE(file.look.given());
  EXPECT_TRUE(file.look.materials.empty());
}

TEST(FbxMaterials, ArnaudWearsColoredBands) {
  LORICA_REQUIRE_DATASET(path, "characters/arnaud/arnaud.fbx");
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  test::expectSound(file);
  ASSERT_EQ(file.look.groups.size(), 1u);
  EXPECT_EQ(file.look.materials.at(0).name, "lambert2");
  EXPECT_NEAR(file.look.materials[0].baseColor.x(), linear(0.4), 1e-6);
  EXPECT_FALSE(file.look.groups[0].flat);
  // A blue collar, a green and a red wristband.
  const auto some = [&](int channel) {
    return std::any_of(file.look.colors.begin(), file.look.colors.end(), [&](const Eigen::Vector4f& c) {
      return c[channel] > 0.9F && c[(channel + 1) % 3] < 0.1F && c[(channel + 2) % 3] < 0.1F;
    });
  };
  for (int channel = 0; channel < 3; ++channel) EXPECT_TRUE(some(channel)) << channel;
}

}  // namespace
}  // namespace lorica
