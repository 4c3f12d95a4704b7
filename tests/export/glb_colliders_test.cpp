#include "export/glb_colliders.h"

#include "skinning/linear_blend.h"
#include "tests/export/stick_figure.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <span>
#include <string>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

struct Made {
  Character figure = test::stickFigure();
  std::vector<RigidCollider> colliders = test::collidersIn(figure, {0.0, 0.6});
  CharacterDocument document = characterDocument(figure);

  explicit Made(const GlbColliderSettings& settings) {
    addColliders(document, colliders, std::vector<std::string>{"lower_0", "upper_0"}, settings);
  }
};

TEST(GlbColliders, HangBelowTheirBonesWithBothExtensions) {
  const Made made({"UCX_", "", true});
  const Json& d = made.document.writer.document;
  EXPECT_EQ(d["extensionsUsed"], Json::array({"OMI_physics_body", "OMI_physics_shape", "KHR_physics_rigid_bodies"}));
  const Json& upper = d["nodes"][1];
  EXPECT_EQ(upper["name"], "upper");
  const Json& hull = d["nodes"][upper["children"].back().get<std::size_t>()];
  EXPECT_EQ(hull["name"], "UCX_upper_0");
  EXPECT_FALSE(hull.contains("translation"));
  const Json& body = hull["extensions"]["OMI_physics_body"];
  EXPECT_EQ(body["motion"]["type"], "kinematic");
  const Json& shape = d["extensions"]["OMI_physics_shape"]["shapes"][body["collider"]["shape"].get<std::size_t>()];
  EXPECT_EQ(shape["type"], "convex");
  EXPECT_EQ(shape["convex"]["mesh"], hull["mesh"]);
  EXPECT_EQ(hull["extensions"]["KHR_physics_rigid_bodies"]["collider"]["geometry"]["mesh"], hull["mesh"]);
}

TEST(GlbColliders, AreDrawnIfTheyAreToBe) {
  for (const bool shown : {true, false}) {
    const Json material = Made({"", "", false, shown}).document.writer.document["materials"].back();
    EXPECT_EQ(material["alphaMode"], shown ? "BLEND" : "MASK");
    EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorFactor"][3], shown ? 0.3 : 0.0);
  }
}

TEST(GlbColliders, KhronosDraftIsWrittenOnlyIfAskedFor) {
  EXPECT_EQ(Made({}).document.writer.document.dump().find("KHR_"), std::string::npos);
}

TEST(GlbColliders, AreInTheFrameOfTheirBone) {
  const Made made({});
  const Json& d = made.document.writer.document;
  const Json& accessor =
      d["accessors"][d["meshes"].back()["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
  Aabb box;
  for (const Vec3& p : made.colliders[1].hull.vertices) box.extend(p - Vec3(0.0, 1.0, 0.0));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(accessor["min"][i].get<double>(), box.min[static_cast<int>(i)], 1e-6);
    EXPECT_NEAR(accessor["max"][i].get<double>(), box.max[static_cast<int>(i)], 1e-6);
  }
}

TEST(GlbColliders, AreNoPartOfTheCharacterThatIsReadBack) {
  const auto readBack = [](CharacterDocument& document) {
    const std::string bytes = document.writer.glb("figure.glb").value();
    return parseCharacterFile(std::as_bytes(std::span(bytes)), "figure.glb").value().character;
  };
  CharacterDocument alone = characterDocument(test::stickFigure());
  const Character without = readBack(alone);
  for (const bool shown : {false, true}) {
    Made made({"", "", false, shown});
    const Character with = readBack(made.document);
    EXPECT_EQ(with.mesh.triangles, without.mesh.triangles);
    EXPECT_EQ(with.skeleton.jointCount(), without.skeleton.jointCount());
  }
}

TEST(GlbColliders, OfAMeshAreAFileThatIsReadBack) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "box.glb";
  ASSERT_TRUE(writeGlbHulls(file, {{"part_0", test::makeBox(Vec3(0, 0, 0), Vec3(1, 2, 3))}}, {}).ok());
  const CharacterFile read = readCharacterFile(file).value();
  EXPECT_TRUE(read.isMesh());
  EXPECT_EQ(read.character.mesh.vertices.size(), 8U);
  EXPECT_NEAR(signedVolume(read.character.mesh.vertices, read.character.mesh.triangles), 6.0, 1e-6);
}

}  // namespace
}  // namespace lorica
