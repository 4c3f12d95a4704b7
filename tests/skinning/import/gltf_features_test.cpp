#include "geometry/counts.h"
#include "tests/skinning/import/agreement.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

namespace lorica {
namespace {

using test::GlbWriter;
using test::hasNote;
using test::parsed;
using test::smallCharacter;

[[nodiscard]] JointIndex jointNamed(const CharacterFile& file, const std::string& name) {
  const std::span<const Joint> joints = file.character.skeleton.joints();
  const auto found = std::ranges::find(joints, name, &Joint::name);
  return found == joints.end() ? kNoJoint : static_cast<JointIndex>(found - joints.begin());
}

void expectInfluences(const CharacterFile& file, std::size_t vertex, const std::vector<Influence>& expected) {
  const Character& c = file.character;
  ASSERT_EQ(c.influenceBegin[vertex + 1] - c.influenceBegin[vertex], countOf(expected)) << vertex;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Influence& got = c.influences[c.influenceBegin[vertex] + i];
    EXPECT_EQ(got.joint, expected[i].joint) << vertex;
    EXPECT_NEAR(got.weight, expected[i].weight, 1e-12) << vertex;
  }
}

TEST(GltfFeatures, ASmallCharacterIsReadWhole) {
  const Result<CharacterFile> file = parsed(smallCharacter());
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->format, "glTF 2.0");
  EXPECT_EQ(file->character.name, "hero");
  EXPECT_EQ(file->character.skeleton.jointCount(), 3);  // (file), lower, upper
  EXPECT_EQ(file->character.mesh.vertices.size(), 8u);
  EXPECT_EQ(file->character.mesh.triangles.size(), 12u);
  EXPECT_NEAR(file->character.height, 2.0, 1e-6);
  EXPECT_EQ(file->metresPerUnit, 1.0);
  EXPECT_EQ(file->meshes, 1);
  EXPECT_EQ(file->primitives, 1);
  EXPECT_EQ(file->skins, 1);
  EXPECT_EQ(file->maxInfluences, 1);
  EXPECT_EQ(file->repairedVertices, 0);
  EXPECT_TRUE(file->notes.empty());
  ASSERT_EQ(file->clips.size(), 1u);
  EXPECT_EQ(file->clips[0].name, "bend");
  EXPECT_EQ(file->clips[0].seconds, 2.0);
  // A quarter turn about Z at 1 m takes the corner (0.2, 2) to (-1, 1.2).
  const std::vector<Vec3> bent = test::posedVertices(*file, 0, 2.0);
  for (std::size_t v = 0; v < bent.size(); ++v) {
    const Vec3& p = file->character.mesh.vertices[v];
    const Vec3 expected = p.y() > 1.0 ? Vec3(1.0 - p.y(), 1.0 + p.x(), p.z()) : p;
    EXPECT_NEAR((bent[v] - expected).norm(), 0.0, 1e-6);
  }
}

TEST(GltfFeatures, BrokenImagesDoNotMatter) {
  GlbWriter writer = smallCharacter();
  writer.document["images"] = {{{"uri", "../../etc/passwd"}},
                               {{"bufferView", 4711}, {"mimeType", "image/png"}},
                               {{"uri", "data:image/png;base64,!!"}},
                               nullptr};
  writer.document["textures"] = {{{"source", 99}}};
  writer.document["materials"] = "none";
  writer.document["extras"] = {{"deep", {1, 2, 3}}};
  const Result<CharacterFile> file = parsed(writer);
  EXPECT_TRUE(file.ok()) << file.error().message;
}

TEST(GltfFeatures, NormalisedWeightsAreSharesOfTheirWhole) {
  GlbWriter writer = smallCharacter();
  std::vector<std::uint8_t> joints, weights;
  for (int v = 0; v < 8; ++v) {
    joints.insert(joints.end(), {0, 1, 0, 0});
    weights.insert(weights.end(), {204, 51, 0, 0});
  }
  auto& attributes = writer.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = writer.accessor(joints, "VEC4");
  attributes["WEIGHTS_0"] = writer.accessor(weights, "VEC4", true);
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.repairedVertices, 0);
  EXPECT_EQ(file.maxInfluences, 2);
  expectInfluences(file, 3, {{jointNamed(file, "lower"), 0.8}, {jointNamed(file, "upper"), 0.2}});
}

TEST(GltfFeatures, WeightsAreRepairedAndCounted) {
  GlbWriter writer = smallCharacter();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::uint8_t> joints = {0, 1,  0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0,  1, 0, 0,
                                            1, 77, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 99, 0, 0, 0};
  const std::vector<float> weights = {0.5F, 0.5F, 0, 0, 1, 3, 0, 0, 0.5F,  -0.5F, 0,    0, nan, 0.25F, 0, 0,
                                      0.5F, 0.5F, 0, 0, 0, 0, 0, 0, 0.25F, 0.25F, 0.5F, 0, 1,   0,     0, 0};
  auto& attributes = writer.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = writer.accessor(joints, "VEC4");
  attributes["WEIGHTS_0"] = writer.accessor(weights, "VEC4");
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.repairedVertices, 6);
  EXPECT_TRUE(hasNote(file, "6 vertices had weights"));
  const JointIndex lower = jointNamed(file, "lower"), upper = jointNamed(file, "upper");
  const std::vector<std::vector<Influence>> expected = {{{lower, 0.5}, {upper, 0.5}},
                                                        {{lower, 0.25}, {upper, 0.75}},  // summed to 4
                                                        {{lower, 1.0}},                  // one was negative
                                                        {{upper, 1.0}},                  // one was not a number
                                                        {{upper, 1.0}},   // one referred to a missing bone
                                                        {{upper, 1.0}},   // all were zero: the first joint listed
                                                        {{upper, 1.0}},   // three times the same
                                                        {{lower, 1.0}}};  // none referred to an existing bone
  for (std::size_t v = 0; v < 8; ++v) {
    expectInfluences(file, v, expected[v]);
  }
}

TEST(GltfFeatures, ASparseAccessorReplacesOnlyWhatItNames) {
  GlbWriter writer = smallCharacter();
  const int rows = writer.view(std::vector<std::uint8_t>{2, 5});
  const int values = writer.view(std::vector<float>{9, 8, 7, -1, -2, -3});
  writer.document["accessors"][0]["sparse"] = test::sparse(2, rows, 5121, values);
  const Result<CharacterFile> plain = parsed(smallCharacter());
  const CharacterFile file = test::valueOf(parsed(writer));
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3 expected = v == 2 ? Vec3(9, 8, 7) : v == 5 ? Vec3(-1, -2, -3) : plain->character.mesh.vertices[v];
    EXPECT_EQ(file.character.mesh.vertices[v], expected) << v;
  }
}

TEST(GltfFeatures, OneBoneBoundInTwoWaysIsTwoJoints) {
  GlbWriter writer = smallCharacter();
  // A second skin over the same bones, whose upper one was bound rotated by 90 degrees and half a metre lower.
  const Affine3 turned = Eigen::Translation3d(0.0, 0.5, 0.0) *
                         Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()) *
                         Eigen::Translation3d(0.0, -1.0, 0.0);
  const std::vector<Affine3> inverseBinds = {Affine3::Identity(), turned};
  const int accessor = writer.matrices(inverseBinds);
  writer.add("skins", {{"joints", {0, 1}}, {"inverseBindMatrices", accessor}});
  writer.add("nodes", {{"mesh", 0}, {"skin", 1}});
  writer.document["scenes"][0]["nodes"].push_back(3);
  const CharacterFile file = test::valueOf(parsed(writer));
  ASSERT_EQ(file.character.skeleton.jointCount(), 4);
  const Joint& copy = file.character.skeleton.joint(3);
  EXPECT_EQ(copy.name, "upper (bind 2)");
  EXPECT_EQ(copy.parent, jointNamed(file, "upper"));
  EXPECT_TRUE(copy.rest.matrix().isApprox(Affine3::Identity()));
  EXPECT_TRUE(hasNote(file, "1 joint added"));
  const test::GltfTruth truth(writer.glb());
  EXPECT_LE(test::farthestFromTruth(file, truth, -1, 0.0), 2e-6);
  EXPECT_LE(test::farthestFromTruth(file, truth, 0, 1.3), 2e-6);
}

TEST(GltfFeatures, SkinsThatDifferOnlyInTheSpaceOfTheirVerticesShareJoints) {
  GlbWriter writer = smallCharacter();
  // The same box in centimetres, lying down: its inverse bind matrices stand it up.
  const Affine3 metresFromOther(
      Mat3(0.01 * Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vec3::UnitX()).toRotationMatrix()));
  std::vector<Vec3> points;
  for (const Vec3& p : test::makeBox(Vec3(-0.2, 0.0, -0.2), Vec3(0.2, 2.0, 0.2)).vertices) {
    points.emplace_back(metresFromOther.inverse() * p);
  }
  const std::vector<Affine3> inverseBinds = {metresFromOther,
                                             Affine3(Eigen::Translation3d(0.0, -1.0, 0.0) * metresFromOther)};
  const int accessor = writer.matrices(inverseBinds);
  writer.add("skins", {{"joints", {0, 1}}, {"inverseBindMatrices", accessor}});
  nlohmann::json mesh = writer.document["meshes"][0];
  mesh["primitives"][0]["attributes"]["POSITION"] = writer.positions(points);
  writer.add("meshes", mesh);
  writer.add("nodes", {{"mesh", 1}, {"skin", 1}});
  writer.document["scenes"][0]["nodes"].push_back(3);
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.character.skeleton.jointCount(), 3);
  EXPECT_EQ(file.metresPerUnit, 1.0);
  for (std::size_t v = 0; v < 8; ++v) {
    EXPECT_NEAR((file.character.mesh.vertices[v] - file.character.mesh.vertices[v + 8]).norm(), 0.0, 1e-6);
  }
}

TEST(GltfFeatures, TheBindPoseStaysAsItWasWhereTheRestPoseIsAnother) {
  GlbWriter writer = smallCharacter();
  const double half = std::sqrt(0.5);
  writer.document["nodes"][1]["rotation"] = {0.0, 0.0, half, half};  // bent at rest
  const Result<CharacterFile> file = parsed(writer);
  const Result<CharacterFile> straight = parsed(smallCharacter());
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_NEAR(file->character.height, 2.0, 1e-6);
  for (std::size_t v = 0; v < 8; ++v) {
    EXPECT_NEAR((file->character.mesh.vertices[v] - straight->character.mesh.vertices[v]).norm(), 0.0, 1e-6);
  }
  EXPECT_LE(test::farthestFromTruth(*file, test::GltfTruth(writer.glb()), -1, 0.0), 2e-6);
}

TEST(GltfFeatures, ARigidMeshHangsOnItsNode) {
  GlbWriter writer = smallCharacter();
  const TriMesh hat = test::makeTetrahedron();
  const int positions = writer.positions(hat.vertices);
  const int indices = writer.triangles(hat.triangles);
  writer.add("meshes", {{"primitives", {{{"indices", indices}, {"attributes", {{"POSITION", positions}}}}}}});
  writer.add("nodes", {{"name", "hat"}, {"mesh", 1}, {"translation", {0.0, 1.0, 0.0}}});
  writer.document["nodes"][1]["children"] = {3};
  const CharacterFile file = test::valueOf(parsed(writer));
  const JointIndex joint = jointNamed(file, "hat");
  ASSERT_NE(joint, kNoJoint);
  EXPECT_EQ(file.character.skeleton.joint(joint).parent, jointNamed(file, "upper"));
  for (std::size_t v = 8; v < 12; ++v) expectInfluences(file, v, {{joint, 1.0}});
  EXPECT_NEAR(boundsOf(file.character.mesh.vertices).max.y(), 3.0, 1e-6);
  EXPECT_LE(test::farthestFromTruth(file, test::GltfTruth(writer.glb()), 0, 1.1), 2e-6);
}

TEST(GltfFeatures, AMeshWithoutASkinIsAStaticShape) {
  GlbWriter writer = smallCharacter();
  for (const char* key : {"skins", "animations"}) writer.document.erase(key);
  writer.document["nodes"][2].erase("skin");
  writer.document["nodes"][2]["scale"] = {-1.0, 2.0, 1.0};  // mirrored
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_TRUE(hasNote(file, "") || file.notes.empty());
  EXPECT_NEAR(file.character.height, 4.0, 1e-6);
  EXPECT_NEAR(signedVolume(file.character.mesh.vertices, file.character.mesh.triangles), 0.64, 1e-6);
  EXPECT_TRUE(file.clips.empty());
}

TEST(GltfFeatures, AFlatNodeOpensWhereAClipScalesIt) {
  GlbWriter writer = smallCharacter();
  writer.document["nodes"][2].erase("skin");
  writer.document["nodes"][2]["scale"] = {0.0, 0.0, 0.0};
  const int times = writer.accessor(std::vector<float>{0.0F, 1.0F}, "SCALAR");
  const int scales = writer.accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "VEC3");
  writer.add("animations", {{"samplers", {{{"input", times}, {"output", scales}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "scale"}}}}}}});
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_NEAR(file.character.height, 2.0, 1e-6);
  const test::GltfTruth truth(writer.glb());
  EXPECT_LE(test::farthestFromTruth(file, truth, 1, 0.0), 1e-6);
  EXPECT_LE(test::farthestFromTruth(file, truth, 1, 0.25), 1e-6);
  EXPECT_EQ(file.clips[1].name, "clip 1");
}

TEST(GltfFeatures, StripsAndFansCoverWhatTheirTrianglesDo) {
  // The unit square as a strip, a fan, and two triangles, with and without indices.
  const std::vector<float> strip = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const std::vector<float> fan = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<float> list = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0};
  for (const auto& [mode, points] : {std::pair(5, strip), std::pair(6, fan), std::pair(4, list)}) {
    GlbWriter writer;
    const int positions = writer.accessor(points, "VEC3");
    writer.add("meshes", {{"primitives", {{{"mode", mode}, {"attributes", {{"POSITION", positions}}}}}}});
    writer.add("nodes", {{"mesh", 0}});
    const CharacterFile file = test::valueOf(parsed(writer));
    const TriMesh& mesh = file.character.mesh;
    ASSERT_EQ(mesh.triangles.size(), 2u) << mode;
    EXPECT_NEAR(surfaceArea(mesh.vertices, mesh.triangles), 1.0, 1e-12);
    for (const Triangle& t : mesh.triangles) {  // all face +Z
      const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
      EXPECT_GT((b - a).cross(c - a).z(), 0.5) << mode;
    }
  }
}

TEST(GltfFeatures, PointsAndLinesAndEmptyTrianglesAreLeftOutWithANote) {
  GlbWriter writer = smallCharacter();
  nlohmann::json& primitives = writer.document["meshes"][0]["primitives"];
  const nlohmann::json sound = primitives[0];
  for (int copies = 0; copies < 3; ++copies) primitives.push_back(sound);
  primitives[1]["mode"] = 0;  // points
  primitives[2]["mode"] = 3;  // lines
  primitives[3]["indices"] = writer.accessor(std::vector<std::uint16_t>{0, 1, 2, 3, 3, 4, 5, 6, 5, 0, 1}, "SCALAR");
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.character.mesh.triangles.size(), 13u);
  EXPECT_EQ(file.character.mesh.vertices.size(), 11u);  // three of the second list are used
  EXPECT_TRUE(hasNote(file, "2 primitives are points or lines"));
  EXPECT_TRUE(hasNote(file, "2 triangles use a vertex twice"));
  EXPECT_TRUE(hasNote(file, "2 indices do not form a complete triangle"));
}

TEST(GltfFeatures, MorphTargetsShapeTheRestByTheWeightsOfTheNodeElseOfTheMesh) {
  GlbWriter writer = smallCharacter();
  std::vector<float> up(24, 0.0F);
  for (std::size_t v = 0; v < 8; ++v) up[3 * v + 1] = 1.0F;
  const int offsets = writer.accessor(up, "VEC3");
  nlohmann::json& mesh = writer.document["meshes"][0];
  mesh["primitives"][0]["targets"] = {{{"POSITION", offsets}}, {{"NORMAL", 12345}}};
  const auto lowest = [&] {
    const Result<CharacterFile> file = parsed(writer);
    EXPECT_TRUE(file.ok()) << file.error().message;
    EXPECT_EQ(file->morphTargets, 2);
    return boundsOf(file->character.mesh.vertices).min.y();
  };
  EXPECT_NEAR(lowest(), 0.0, 1e-6);
  mesh["weights"] = {0.25, 1.0};
  EXPECT_NEAR(lowest(), 0.25, 1e-6);
  writer.document["nodes"][2]["weights"] = {0.5};
  EXPECT_NEAR(lowest(), 0.5, 1e-6);
}

TEST(GltfFeatures, MissingInverseBindMatricesAreIdentities) {
  GlbWriter writer = smallCharacter();
  writer.document["skins"][0].erase("inverseBindMatrices");
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_LE(test::farthestFromTruth(file, test::GltfTruth(writer.glb()), 0, 0.7), 2e-6);
}

TEST(GltfFeatures, OnlyWhatTheDefaultSceneDrawsIsRead) {
  GlbWriter writer = smallCharacter();
  writer.add("nodes", {{"mesh", 0}});
  writer.add("scenes", {{"nodes", {3}}});
  CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.character.mesh.triangles.size(), 12u);
  EXPECT_EQ(file.maxInfluences, 1);
  EXPECT_TRUE(hasNote(file, "1 node with a mesh is not in the drawn scene"));
  writer.document.erase("scenes");
  file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.character.mesh.triangles.size(), 24u);
}

TEST(GltfFeatures, LateKeysAndOddChannelsAreLeftOutWithANote) {
  GlbWriter writer = smallCharacter();
  const int times = writer.accessor(std::vector<float>{0.0F, 1.0F, 1.0F, 0.5F, 3.0F}, "SCALAR");
  const int values = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4, 0, 0}, "VEC3");
  nlohmann::json& animation = writer.document["animations"][0];
  animation["samplers"].push_back({{"input", times}, {"output", values}});
  const auto add = [&](nlohmann::json target) {
    animation["channels"].push_back({{"sampler", 1}, {"target", target}});
  };
  add({{"node", 1}, {"path", "translation"}});
  add({{"node", 1}, {"path", "translation"}});
  add({{"node", 2}, {"path", "weights"}});
  add({{"node", 1}, {"path", "pointer"}});
  const CharacterFile file = test::valueOf(parsed(writer));
  ASSERT_EQ(file.clips.size(), 1u);
  ASSERT_EQ(file.clips[0].tracks.size(), 1u);
  const KeyTrack<Vec3>& track = *file.clips[0].tracks[0].translation;
  EXPECT_EQ(track.times, (std::vector<double>{0.0, 1.0, 3.0}));
  EXPECT_EQ(track.values[2], Vec3(4.0, 0.0, 0.0));
  EXPECT_TRUE(hasNote(file, "2 animation keys are not later than"));
  EXPECT_TRUE(hasNote(file, "1 animation channel of morph weights could not be read: skipped"));
  EXPECT_TRUE(hasNote(file, "1 animation channel animates something other"));
  EXPECT_TRUE(hasNote(file, "1 animation channel animates what another already animates"));
}

TEST(GltfFeatures, VrmListsNameTheBones) {
  GlbWriter writer = smallCharacter();
  writer.document["extensions"]["VRMC_vrm"] = nlohmann::json::parse(
      R"({"specVersion": "1.0", "humanoid": {"humanBones": {"hips": {"node": 0}, "leftThumbProximal": {"node": 1},
          "jaw": {"node": 1}, "head": {"node": 4711}, "spine": {"node": 1}, "neck": "none"}}})");
  CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.format, "VRM 1.0");
  EXPECT_EQ(file.character.skeleton.jointOf(HumanBone::kHips), jointNamed(file, "lower"));
  EXPECT_EQ(file.character.skeleton.jointOf(HumanBone::kLeftThumbProximal), jointNamed(file, "upper"));
  EXPECT_EQ(file.character.skeleton.jointOf(HumanBone::kHead), kNoJoint);
  EXPECT_TRUE(hasNote(file, "bone head refers to node 4711"));
  EXPECT_TRUE(hasNote(file, "bone neck refers to node null"));
  EXPECT_TRUE(hasNote(file, "bone spine or its node 1 is listed twice"));
  EXPECT_NEAR(boundsOf(file.character.mesh.vertices).max.y(), 2.0, 1e-6);

  // In 0.x the bones are a list, the thumb's bones have other names, and the front is -Z.
  writer.document["extensions"] = nlohmann::json::parse(
      R"({"VRM": {"humanoid": {"humanBones": [{"bone": "hips", "node": 0},
          {"bone": "leftThumbIntermediate", "node": 1}, {"bone": 7}, "none"]}}})");
  file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.format, "VRM 0.x");
  EXPECT_EQ(file.character.skeleton.jointOf(HumanBone::kLeftThumbProximal), jointNamed(file, "upper"));
  EXPECT_LE(test::farthestFromTruth(file, test::GltfTruth(writer.glb()), 0, 1.9), 2e-6);
}

TEST(GltfFeatures, AUnitIsGuessedOnlyTowardsAHuman) {
  // The scale of a character that is 2 m high, the unit, and whether it is said.
  for (const auto& [size, expected, said] : {std::tuple(1.0, 1.0, false),
                                             {4.0, 1.0, false},
                                             {5.28, 1.0, true},
                                             {27.0, 1.0, true},
                                             {29.0, 0.01, true},
                                             {75.0, 0.01, true},
                                             {900.0, 0.001, true},
                                             {1e4, 0.001, true},
                                             {0.011, 1.0, false},
                                             {0.008, 100.0, true},
                                             {0.0009, 1000.0, true},
                                             {1e-5, 1000.0, true}}) {
    GlbWriter writer = smallCharacter();
    writer.add("nodes", {{"scale", {size, size, size}}, {"children", {0, 2}}});
    writer.document["scenes"][0]["nodes"] = {3};
    const CharacterFile file = test::valueOf(parsed(writer));
    EXPECT_EQ(file.metresPerUnit, expected) << size;
    EXPECT_NEAR(file.character.height, 2.0 * size * expected, 1e-5 * file.character.height);
    EXPECT_EQ(hasNote(file, "m per unit"), said) << size;
    EXPECT_LE(test::farthestFromTruth(file, test::GltfTruth(writer.glb()), 0, 1.2), 1e-5 * file.character.height);
  }
}

TEST(GltfFeatures, AFileOfMotionAloneHasEveryNodeAndNoMesh) {
  GlbWriter writer = smallCharacter();
  for (const char* key : {"skins", "meshes"}) writer.document.erase(key);
  writer.document["nodes"][2] = {{"name", "tip"}};
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_EQ(file.character.skeleton.jointCount(), 4);
  EXPECT_TRUE(file.character.mesh.vertices.empty());
  EXPECT_EQ(file.character.height, 0.0);
  ASSERT_EQ(file.clips.size(), 1u);
}

TEST(GltfFeatures, AFileThatFloatsIsToldAbout) {
  GlbWriter writer = smallCharacter();
  writer.document["nodes"][0]["translation"] = {0.0, 0.5, 0.0};
  const CharacterFile file = test::valueOf(parsed(writer));
  EXPECT_TRUE(hasNote(file, "lowest point in the bind pose is at y = 0.500 m"));
}

}  // namespace
}  // namespace lorica
