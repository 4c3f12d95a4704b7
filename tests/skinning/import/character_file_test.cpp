#include "skinning/import/character_file.h"

#include "geometry/counts.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/import/character_parts.h"
#include "tests/skinning/humanoid/humanoid_samples.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::isDoubted;
using enum HumanBone;
using test::GlbWriter;
using test::makeBox;
using test::smallCharacter;

TEST(CharacterFile, IsKnownByTheEndOfItsName) {
  for (const char* name : {"a.gltf", "a.glb", "b.VRM", "w.vrma", "x/y.Fbx", "z.tar.dae"})
    EXPECT_TRUE(isCharacterFile(name)) << name;
  for (const char* name : {"a.bvh", "glb", ".glb.txt", "a.obj", "", "a."}) EXPECT_FALSE(isCharacterFile(name)) << name;
}

TEST(CharacterFile, IsReadByWhatIsInIt) {
  const test::TemporaryFolder folder;
  const std::filesystem::path misnamed = folder.write("hero.fbx", test::smallCharacter().glb());
  const CharacterFile file = test::valueOf(readCharacterFile(misnamed));
  EXPECT_EQ(file.format, "glTF 2.0");
  EXPECT_EQ(file.character.name, "hero");
}

/// Its nodes may have any names: the extension says which are bones.
TEST(CharacterFile, AVrmAnimationNamesItsBones) {
  test::GlbWriter writer = test::smallCharacter();
  for (const char* key : {"meshes", "skins", "materials"}) writer.document.erase(key);
  writer.document["nodes"].erase(2);
  writer.document["scenes"][0]["nodes"] = {0};
  writer.document["extensions"]["VRMC_vrm_animation"] = nlohmann::json::parse(
      R"({"specVersion": "1.0", "humanoid": {"humanBones": {"hips": {"node": 0}, "spine": {"node": 1}}}})");
  const test::TemporaryFolder folder;
  const CharacterFile file = test::valueOf(readCharacterFile(folder.write("wave.vrma", writer.glb())));
  EXPECT_EQ(file.format, "VRM animation 1.0");
  ASSERT_EQ(file.clips.size(), 1U);
  const Skeleton& skeleton = file.character.skeleton;
  EXPECT_EQ(skeleton.joint(skeleton.jointOf(HumanBone::kSpine)).name, "upper");
}

TEST(CharacterFile, WhatIsNoneIsRefusedInASentence) {
  const test::TemporaryFolder folder;
  const auto complaint = [](const std::filesystem::path& path) {
    const Result<CharacterFile> file = readCharacterFile(path);
    return file.ok() ? std::string() : file.error().message;
  };
  const std::filesystem::path text = folder.write("a.glb", "once upon a time");
  EXPECT_EQ(complaint(text), text.string() + ": unknown format, expected glTF, VRM, FBX or COLLADA");
  const std::filesystem::path blank = folder.write("b.glb", "  \n ");
  EXPECT_EQ(complaint(blank), blank.string() + ": unknown format, expected glTF, VRM, FBX or COLLADA");
  const std::filesystem::path empty = folder.write("c.vrm", "");
  EXPECT_EQ(complaint(empty), empty.string() + ": is empty, expected a character");
  EXPECT_NE(complaint(folder.path() / "absent.glb"), "");
  EXPECT_NE(complaint(folder.path()), "");
}

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

// The shared characters with their names replaced by numbers: what the shape alone finds, against what the names say.

[[nodiscard]] Skeleton nameless(const Skeleton& skeleton) {
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i].name = std::to_string(i * 2654435761u);
    joints[i].bone.reset();
  }
  return std::move(*Skeleton::create(std::move(joints)));
}

/// What the shape takes for another joint than the names do.
void expectShape(const char* path, const std::map<HumanBone, std::string>& taken) {
  LORICA_REQUIRE_DATASET(file, std::string("characters/") + path);
  const CharacterFile read = test::valueOf(readCharacterFile(file));
  const Skeleton& own = read.character.skeleton;
  const Skeleton erased = nameless(own);
  const HumanoidGuess guess = guessHumanoid(erased);
  ASSERT_EQ(guess.by, "the skeleton's shape");
  EXPECT_EQ(test::contradictions(erased, guess), "");
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    const auto other = taken.find(bone);
    const std::string found = guess[bone] == kNoJoint ? "" : own.joint(guess[bone]).name;
    const std::string named = own.jointOf(bone) == kNoJoint ? "" : own.joint(own.jointOf(bone)).name;
    if (other != taken.end()) {
      EXPECT_EQ(found, other->second) << path << ", " << nameOf(bone);
    } else if (!isDoubted(guess, bone)) {
      EXPECT_EQ(found, named) << path << ", " << nameOf(bone);
    }
  }
}

TEST(NamelessCharacters, CesiumMan) {
  expectShape("cesiumman/CesiumMan.glb", {});
}

TEST(NamelessCharacters, BarbarianAndMage) {
  expectShape("kaykit/Barbarian.glb", {});
  expectShape("kaykit/Mage.glb", {});
}

TEST(NamelessCharacters, Godette) {
  // She has no ring fingers; the shape counts from the thumb. Fingers are in doubt in any case.
  expectShape("godette/Godette_vrm_v4.vrm", {{kLeftLittleProximal, ""},
                                             {kLeftLittleIntermediate, ""},
                                             {kLeftLittleDistal, ""},
                                             {kRightLittleProximal, ""},
                                             {kRightLittleIntermediate, ""},
                                             {kRightLittleDistal, ""}});
}

TEST(NamelessCharacters, Arnaud) {
  // His thighs hang on the second joint, and his arms on the neck.
  const std::map<HumanBone, std::string> others = {
      {kHips, "Spine"}, {kChest, "Spine3"}, {kUpperChest, "Neck"}, {kNeck, ""}};
  for (const char* file : {"arnaud", "walk", "run", "crossarms", "atlas"}) {
    expectShape((std::string("arnaud/") + file + ".fbx").c_str(), others);
  }
}

TEST(NamelessCharacters, Robot) {
  // One joint more counts as trunk, the last of the neck's as the top of the head; its palms are in doubt, their finger
  // with them.
  expectShape("raylib_robot/robot.glb", {{kSpine, "Hips"},
                                         {kChest, "Abdomen"},
                                         {kUpperChest, "Torso"},
                                         {kNeck, ""},
                                         {kHead, "Neck"},
                                         {kLeftMiddleProximal, ""},
                                         {kLeftMiddleIntermediate, ""},
                                         {kRightMiddleProximal, ""},
                                         {kRightMiddleIntermediate, ""}});
}

// Limbs of one joint do not prove a body, and an animal is none: a user gets a map to correct.
TEST(NamelessCharacters, GreenmanAndTheFoxAreOnlySuggested) {
  for (const char* path : {"greenman/greenman.glb", "fox/Fox.glb"}) {
    LORICA_REQUIRE_DATASET(file, std::string("characters/") + path);
    const CharacterFile read = test::valueOf(readCharacterFile(file));
    const Skeleton erased = nameless(read.character.skeleton);
    EXPECT_EQ(guessHumanoid(erased)[kHips], kNoJoint) << path;
    const HumanoidGuess suggested = suggestHumanoid(erased);
    EXPECT_NE(suggested[kHips], kNoJoint) << path;
    for (int i = 0; i < kHumanBoneCount; ++i) {
      const auto bone = static_cast<HumanBone>(i);
      EXPECT_EQ(suggested[bone] != kNoJoint, isDoubted(suggested, bone)) << path << ", " << nameOf(bone);
    }
    EXPECT_EQ(test::contradictions(erased, suggested), "") << path;
  }
}

TEST(NamelessCharacters, GreenmansSuggestionIsRight) {
  LORICA_REQUIRE_DATASET(file, "characters/greenman/greenman.glb");
  const CharacterFile read = test::valueOf(readCharacterFile(file));
  const Skeleton& own = read.character.skeleton;
  const HumanoidGuess suggested = suggestHumanoid(nameless(own));
  for (const HumanBone bone : {kHips, kSpine, kHead, kLeftUpperLeg, kRightUpperLeg, kLeftUpperArm, kRightUpperArm}) {
    EXPECT_EQ(suggested[bone], own.jointOf(bone)) << nameOf(bone);
  }
}

/// Adds a rigid box on a node below "upper".
void addTool(GlbWriter& writer, const std::string& node, const std::string& mesh, const Vec3& size) {
  const TriMesh box = makeBox(Vec3::Zero(), size);
  const int positions = writer.positions(box.vertices);
  const int indices = writer.triangles(box.triangles);
  const int index = writer.add(
      "meshes", {{"name", mesh}, {"primitives", {{{"indices", indices}, {"attributes", {{"POSITION", positions}}}}}}});
  const int added = writer.add("nodes", {{"name", node}, {"mesh", index}, {"translation", {0.2, 0.5, 0.0}}});
  writer.document["nodes"][1]["children"].push_back(added);
}

GlbWriter armed() {
  GlbWriter writer = smallCharacter();
  addTool(writer, "Axe.R", "Cube.007", Vec3(0.1, 0.1, 0.5));
  addTool(writer, "Shield", "Cube.008", Vec3(0.5, 0.5, 0.1));
  return writer;
}

Result<CharacterFile> readWithout(const GlbWriter& writer, std::vector<std::string> hidden = {}) {
  const std::string glb = writer.glb();
  return parseCharacterFile(std::as_bytes(std::span(glb)), "hero.glb", {std::move(hidden)});
}

std::string problemOf(const GlbWriter& writer, std::vector<std::string> hidden) {
  const Result<CharacterFile> file = readWithout(writer, std::move(hidden));
  if (file) return "none";
  EXPECT_EQ(file.error().code, ErrorCode::kInvalidArgument);
  return file.error().message;
}

/// Mesh, skeleton, weights and clips are the same bit for bit.
void expectSame(const CharacterFile& a, const CharacterFile& b) {
  EXPECT_EQ(a.character.mesh.vertices, b.character.mesh.vertices);
  EXPECT_EQ(a.character.mesh.triangles, b.character.mesh.triangles);
  EXPECT_EQ(a.character.influenceBegin, b.character.influenceBegin);
  ASSERT_EQ(a.character.skeleton.jointCount(), b.character.skeleton.jointCount());
  for (JointIndex j = 0; j < a.character.skeleton.jointCount(); ++j) {
    EXPECT_EQ(a.character.skeleton.joint(j).name, b.character.skeleton.joint(j).name);
    EXPECT_EQ(a.character.jointFromModel[j].matrix(), b.character.jointFromModel[j].matrix());
  }
  EXPECT_EQ(a.clips.size(), b.clips.size());
  EXPECT_EQ(a.character.height, b.character.height);
}

TEST(HiddenMeshes, AFileIsReadAsIfTheyWereNotInIt) {
  const CharacterFile bare = readWithout(smallCharacter()).value();
  GlbWriter shielded = smallCharacter();
  addTool(shielded, "Shield", "Cube.008", Vec3(0.5, 0.5, 0.1));
  expectSame(readWithout(armed(), {"Axe.R", "Shield"}).value(), bare);
  expectSame(readWithout(armed(), {"Axe.R"}).value(), readWithout(shielded).value());
  EXPECT_GT(readWithout(armed()).value().character.mesh.vertices.size(), bare.character.mesh.vertices.size());
}

TEST(HiddenMeshes, ANameIsThatOfTheMeshOrItsNodeInAnyCase) {
  const CharacterFile byNode = readWithout(armed(), {"axe.r"}).value();
  expectSame(readWithout(armed(), {"CUBE.007"}).value(), byNode);
  expectSame(readWithout(armed(), {"Cube.007", "Axe.R", "Axe.R"}).value(), byNode);
  ASSERT_EQ(byNode.meshNames.size(), 2u);
  EXPECT_EQ(byNode.meshNames[0].text(), "box (Body)");
  EXPECT_EQ(byNode.meshNames[1].text(), "Shield (Cube.008)");
}

TEST(HiddenMeshes, NodesThatShareAMeshAreHiddenOneByOneOrTogether) {
  GlbWriter writer = armed();
  const auto axe = writer.document["nodes"][3]["mesh"];
  const int second = writer.add("nodes", {{"name", "Axe.L"}, {"mesh", axe}});
  writer.document["nodes"][0]["children"].push_back(second);
  const std::size_t all = readWithout(writer).value().character.mesh.triangles.size();
  EXPECT_EQ(all, 48u);
  EXPECT_EQ(readWithout(writer, {"Axe.L"}).value().character.mesh.triangles.size(), 36u);
  EXPECT_EQ(readWithout(writer, {"Cube.007"}).value().character.mesh.triangles.size(), 24u);
}

TEST(HiddenMeshes, ASkinnedMeshIsHiddenWithoutItsBones) {
  GlbWriter writer = armed();
  const CharacterFile file = readWithout(writer, {"Body"}).value();
  EXPECT_EQ(file.character.mesh.triangles.size(), 24u);
  EXPECT_EQ(file.clips.size(), 1u);
}

TEST(HiddenMeshes, TheUnitIsThatOfTheWholeFile) {
  // 150 units are taken for centimetres, 2 for metres.
  GlbWriter writer = smallCharacter();
  addTool(writer, "Flagpole", "Cube.009", Vec3(0.1, 150.0, 0.1));
  EXPECT_EQ(readWithout(smallCharacter()).value().metresPerUnit, 1.0);
  EXPECT_EQ(readWithout(writer).value().metresPerUnit, 0.01);
  EXPECT_EQ(readWithout(writer, {"Flagpole"}).value().metresPerUnit, 0.01);
}

TEST(HiddenMeshes, AnUnknownNameIsASentenceThatListsTheMeshes) {
  EXPECT_EQ(problemOf(armed(), {"Shield", "Sword"}),
            "hero.glb: no mesh named `Sword` to hide, expected one of box (Body), Axe.R (Cube.007), Shield (Cube.008)");
  GlbWriter crowd = smallCharacter();
  for (int i = 0; i < 50; ++i) addTool(crowd, "Leaf" + std::to_string(i), "", Vec3::Constant(0.1));
  const std::string sentence = problemOf(crowd, {""});
  EXPECT_NE(sentence.find("Leaf38 and 11 more"), std::string::npos) << sentence;

  GlbWriter bones = smallCharacter();
  bones.document["nodes"][2].erase("mesh");
  EXPECT_EQ(problemOf(bones, {"Body"}), "hero.glb: no mesh named `Body` to hide, the file has none");
}

TEST(HiddenMeshes, HidingAllIsASentence) {
  EXPECT_EQ(
      problemOf(armed(), {"Body", "Axe.R", "Shield"}),
      "hero.glb: every mesh is hidden (box (Body), Axe.R (Cube.007), Shield (Cube.008)), expected at least one to "
      "be left");
}

}  // namespace
}  // namespace lorica
