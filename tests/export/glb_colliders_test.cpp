#include "export/glb_colliders.h"

#include "skinning/linear_blend.h"
#include "skinning/springs/spring_collider.h"
#include "tests/export/stick_figure.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
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

constexpr const char* kVrm1 = R"({"VRMC_vrm": {}, "VRMC_springBone": {"specVersion": "1.0",
    "colliders": [{"node": 0, "shape": {"sphere": {"offset": [0, 0, 0], "radius": 0.1}}}],
    "colliderGroups": [{"colliders": [0]}],
    "springs": [{"joints": [], "colliderGroups": [0]}, {"joints": []}]}})";
constexpr const char* kVrm0 = R"({"VRM": {"secondaryAnimation": {"colliderGroups": [],
    "boneGroups": [{"bones": [7], "colliderGroups": []}]}}})";

struct VrmMade {
  Character figure = test::stickFigure();
  std::vector<RigidCollider> colliders = test::collidersIn(figure, {0.0});
  CharacterDocument document = characterDocument(figure);
  SpringBones springs;

  explicit VrmMade(const char* extensions) {
    document.writer.document["extensions"] = Json::parse(extensions);
    springs.chains.resize(1);
  }
  Result<int> add() { return addSpringColliders(document, colliders, figure.skeleton, springs, "hero.vrm"); }
  [[nodiscard]] const Json& extensions() const { return document.writer.document["extensions"]; }
};

TEST(VrmColliders, OfVrm1AreAGroupThatEverySpringUses) {
  VrmMade made(kVrm1);
  ASSERT_EQ(made.add().value(), 2);
  const Json& springBone = made.extensions()["VRMC_springBone"];
  EXPECT_EQ(springBone["colliders"].size(), 3U);
  EXPECT_EQ(springBone["colliderGroups"][1]["colliders"], Json::array({1, 2}));
  EXPECT_EQ(springBone["springs"][0]["colliderGroups"], Json::array({0, 1}));
  EXPECT_EQ(springBone["springs"][1]["colliderGroups"], Json::array({1}));
  const Json& capsule = springBone["colliders"][2]["shape"]["capsule"];
  EXPECT_EQ(springBone["colliders"][2]["node"], 1);
  EXPECT_NEAR(0.5 * (capsule["offset"][1].get<double>() + capsule["tail"][1].get<double>()), 0.5, 1e-6);
  const double r = capsule["radius"];
  const double length = std::abs(capsule["offset"][1].get<double>() - capsule["tail"][1].get<double>());
  EXPECT_NEAR((Capsule{Vec3::Zero(), Vec3(0, length, 0), r}.volume()), 0.04, 1e-6);  // that of the hull
}

TEST(VrmColliders, ChangeNothingElse) {
  VrmMade made(kVrm1);
  Json before = made.document.writer.document;
  const std::string binary = made.document.writer.binary;
  ASSERT_TRUE(made.add());
  Json after = made.document.writer.document;
  before["extensions"].erase("VRMC_springBone");
  after["extensions"].erase("VRMC_springBone");
  EXPECT_EQ(before, after);
  EXPECT_EQ(made.document.writer.binary, binary);
}

TEST(VrmColliders, OfVrm0AreLeftHandedBalls) {
  VrmMade made(kVrm0);
  for (RigidCollider& collider : made.colliders) {
    collider.capsule.from.z() += 0.05;
    collider.capsule.to.z() += 0.05;
  }
  const int added = made.add().value();
  const Json& animation = made.extensions()["VRM"]["secondaryAnimation"];
  ASSERT_EQ(animation["colliderGroups"].size(), 2U);
  EXPECT_EQ(animation["boneGroups"][0]["colliderGroups"], Json::array({0, 1}));
  int balls = 0;
  for (const Json& group : animation["colliderGroups"]) {
    for (const Json& ball : group["colliders"]) {
      EXPECT_NEAR(ball["offset"]["z"].get<double>(), -0.05, 1e-6);
      ++balls;
    }
  }
  EXPECT_EQ(balls, added);
  EXPECT_GT(balls, 2);
}

TEST(VrmColliders, BonesThatSwingGetNone) {
  VrmMade made(kVrm1);
  made.springs.chains[0].joints.push_back({1});
  EXPECT_EQ(made.add().value(), 1);
}

TEST(VrmColliders, WhatHasNoSpringsIsRefused) {
  VrmMade made(kVrm1);
  made.springs.chains.clear();
  EXPECT_TRUE(test::has(made.add().error().message, "no springs"));
  EXPECT_TRUE(test::has(VrmMade("{}").add().error().message, "no VRM"));
}

}  // namespace
}  // namespace lorica
