#include "skinning/clip_files/character_clip.h"

#include "geometry/files.h"
#include "skinning/clip.h"
#include "skinning/import/character_file.h"
#include "skinning/import/gltf_document.h"
#include "skinning/import/gltf_parts.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/import/small_character.h"
#include "tests/skinning/random_pose.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <vector>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::GlbWriter;

/// Random rotations of every joint but those without a node, and a random path of the topmost joints, at uneven times
/// from 5 s on.
SkeletalMotion randomMotion(const CharacterFile& file, int frames, unsigned seed) {
  std::mt19937 random(seed);
  const Skeleton& skeleton = file.character.skeleton;
  SkeletalMotion motion{"random", skeleton, {}, {}};
  double time = 5.0;
  for (int f = 0; f < frames; ++f) {
    motion.times.push_back(time);
    time += uniform(random, 0.01, 0.05);
    Pose pose = restPose(skeleton);
    for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
      const Quat rotation = randomRotation(random);
      const Vec3 shift = randomVector(random, 0.5);
      if (file.nodeOfJoint[j] == -1) continue;
      pose[j].rotation = rotation;
      if (skeleton.joint(j).parent == 0) pose[j].translation += shift / file.metresPerUnit;
    }
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  return motion;
}

std::vector<Vec3> verticesOf(const Character& character, const Pose& pose, std::vector<Affine3>& worldFromJoint) {
  worldFromJoint.resize(pose.size());
  computeWorldFromJoint(character.skeleton, pose, worldFromJoint);
  std::vector<Affine3> skinning(pose.size());
  for (std::size_t j = 0; j < pose.size(); ++j) skinning[j] = worldFromJoint[j] * character.jointFromModel[j];
  std::vector<Vec3> vertices;
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      const Influence& influence = character.influences[i];
      sum += influence.weight * (skinning[influence.joint] * character.mesh.vertices[v]);
    }
    vertices.push_back(sum);
  }
  return vertices;
}

/// The farthest distance between a motion and the first clip of a file, in positions of vertices and of joints of the
/// same name and order [m]. Fails the test if they cannot be compared.
double farthestFrom(const CharacterFile& read, const Character& character, const SkeletalMotion& motion) {
  EXPECT_FALSE(read.clips.empty());
  EXPECT_EQ(read.character.mesh.vertices.size(), character.mesh.vertices.size());
  if (testing::Test::HasFailure()) return std::numeric_limits<double>::infinity();
  double farthest = 0.0;
  std::vector<Affine3> here, there;
  for (int f = 0; f < motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = motion.pose(f);
    const std::vector<Vec3> expected = verticesOf(character, Pose(pose.begin(), pose.end()), here);
    Pose sampled = restPose(read.character.skeleton);
    sampleClip(read.clips.front(), static_cast<float>(motion.times[f] - motion.times.front()), sampled);
    const std::vector<Vec3> found = verticesOf(read.character, sampled, there);
    for (std::size_t v = 0; v < expected.size(); ++v) farthest = std::max(farthest, (expected[v] - found[v]).norm());
    std::multimap<std::string, Vec3> joints;
    for (JointIndex j = 0; j < read.character.skeleton.jointCount(); ++j) {
      joints.emplace(read.character.skeleton.joint(j).name, there[j].translation());
    }
    for (JointIndex j = 1; j < character.skeleton.jointCount(); ++j) {
      double nearest = std::numeric_limits<double>::infinity();
      const auto [begin, end] = joints.equal_range(character.skeleton.joint(j).name);
      for (auto it = begin; it != end; ++it) nearest = std::min(nearest, (it->second - here[j].translation()).norm());
      farthest = std::max(farthest, nearest);
    }
  }
  return farthest;
}

/// The JSON of a .glb.
nlohmann::json documentOf(const std::filesystem::path& glb) {
  const std::string bytes = readFile(glb).value();
  const Result<GltfParts> parts = splitGltf(std::as_bytes(std::span(bytes)), glb.string());
  EXPECT_TRUE(parts.ok());
  return nlohmann::json::parse(parts->json);
}

constexpr double kTolerance = 1e-5;  // [m]

/// Writes a random motion of a file and reads the result back.
struct RoundTrip {
  CharacterFile file;
  SkeletalMotion motion;
  CharacterFile read;
  std::vector<std::string> notes;
};

RoundTrip roundTrip(const fs::path& from, const fs::path& out) {
  CharacterFile file = test::valueOf(readCharacterFile(from));
  RoundTrip trip;
  trip.file = std::move(file);
  trip.motion = test::randomMotion(trip.file, 20, 7);
  const Result<std::vector<std::string>> notes = writeClip(out, {from, &trip.file}, trip.motion);
  EXPECT_TRUE(notes.ok()) << notes.error().message;
  if (notes) trip.notes = *notes;
  CharacterFile read = test::valueOf(readCharacterFile(out));
  trip.read = std::move(read);
  return trip;
}

double farthest(const RoundTrip& trip) {
  return test::farthestFrom(trip.read, trip.file.character, trip.motion);
}

TEST(CharacterClip, IsTheUsersFileWithOneAnimationMore) {
  const test::TemporaryFolder folder;
  const GlbWriter hero = test::smallCharacter();
  const fs::path from = folder.write("hero.glb", hero.glb());
  const fs::path out = folder.path() / "walk.glb";
  const RoundTrip trip = roundTrip(from, out);
  EXPECT_LT(farthest(trip), kTolerance);
  EXPECT_TRUE(trip.notes.empty());
  ASSERT_EQ(trip.read.clips.size(), 2U);
  EXPECT_EQ(trip.read.clips[0].name, "random");
  EXPECT_EQ(trip.read.clips[1].name, "bend");

  json after = test::documentOf(out);
  const json before = test::documentOf(from);
  for (const char* list : {"nodes", "skins", "meshes", "scenes", "asset"}) EXPECT_EQ(after[list], before[list]) << list;
  for (const char* list : {"accessors", "bufferViews"}) {
    for (std::size_t i = 0; i < before[list].size(); ++i) EXPECT_EQ(after[list][i], before[list][i]) << list << i;
  }
  EXPECT_EQ(after["animations"][1], before["animations"][0]);
  for (const json& sampler : after["animations"][0]["samplers"]) EXPECT_EQ(sampler["interpolation"], "LINEAR");
  const json& times = after["accessors"][after["animations"][0]["samplers"][0]["input"].get<std::size_t>()];
  EXPECT_EQ(times["count"], 20);
  EXPECT_EQ(times["min"][0], 0.0);
  const double seconds = trip.motion.times.back() - trip.motion.times.front();
  EXPECT_NEAR(times["max"][0].get<double>(), seconds, 1e-6);
}

TEST(CharacterClip, TheSameInputGivesTheSameBytes) {
  const test::TemporaryFolder folder;
  const fs::path from = folder.write("hero.glb", test::smallCharacter().glb());
  (void)roundTrip(from, folder.path() / "a.glb");
  (void)roundTrip(from, folder.path() / "b.glb");
  EXPECT_EQ(readFile(folder.path() / "a.glb").value(), readFile(folder.path() / "b.glb").value());
}

TEST(CharacterClip, NodesWithMatricesGetTransformsOnlyIfTheyMove) {
  const test::TemporaryFolder folder;
  GlbWriter hero = test::smallCharacter();
  json& upper = hero.document["nodes"][1];
  upper.erase("translation");
  upper["matrix"] = {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 1};  // a quarter turn about Z, twice as large
  hero.document["nodes"][2]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const fs::path out = folder.path() / "walk.glb";
  const RoundTrip trip = roundTrip(folder.write("hero.glb", hero.glb()), out);
  EXPECT_LT(farthest(trip), kTolerance);
  const json document = test::documentOf(out);
  EXPECT_FALSE(document["nodes"][1].contains("matrix"));
  EXPECT_TRUE(document["nodes"][2].contains("matrix"));
}

TEST(CharacterClip, KeepsTheUnitsAndAxesOfTheFile) {
  const test::TemporaryFolder folder;
  GlbWriter hero = test::smallCharacter();
  for (std::size_t i = 0; i < 3; ++i) hero.document["nodes"][i]["name"] = "joint " + std::to_string(i);
  // In centimetres, below an armature that is turned.
  hero.add("nodes",
           {{"name", "armature"}, {"children", {0}}, {"rotation", {0.5, 0.5, 0.5, 0.5}}, {"scale", {100, 100, 100}}});
  hero.document["scenes"][0]["nodes"] = {3, 2};
  const RoundTrip trip = roundTrip(folder.write("hero.glb", hero.glb()), folder.path() / "walk.glb");
  EXPECT_NE(trip.file.metresPerUnit, 1.0);
  EXPECT_EQ(trip.read.metresPerUnit, trip.file.metresPerUnit);
  EXPECT_LT(farthest(trip), kTolerance);
}

TEST(CharacterClip, BuffersAndPicturesOfOtherFilesBecomePartOfIt) {
  const test::TemporaryFolder folder;
  GlbWriter hero = test::smallCharacter();
  const std::string png("\x89PNG\r\n\x1a\n and so on", 18);
  (void)folder.write("skin one.png", png);
  hero.document["images"] = json::array({{{"uri", "skin%20one.png"}}, {{"uri", "gone.png"}}});
  // The last view in a buffer of its own.
  json& view = hero.document["bufferViews"].back();
  const std::string rotations =
      hero.binary.substr(view["byteOffset"].get<std::size_t>(), view["byteLength"].get<std::size_t>());
  hero.document["buffers"] = json::array();
  view["buffer"] = 1;
  view["byteOffset"] = 0;
  json document = json::parse(hero.gltf("hero.bin"));
  document["buffers"].push_back(
      {{"uri", "data:application/octet-stream;base64," + test::base64(rotations)}, {"byteLength", rotations.size()}});
  (void)folder.write("hero.bin", hero.binary);
  const fs::path out = folder.path() / "walk.glb";
  const RoundTrip trip = roundTrip(folder.write("hero.gltf", document.dump()), out);
  EXPECT_LT(farthest(trip), kTolerance);
  ASSERT_EQ(trip.read.clips.size(), 2U);
  EXPECT_EQ(trip.read.clips[1].tracks[0].rotation->values[1].coeffs(),
            trip.file.clips[0].tracks[0].rotation->values[1].coeffs());
  const json after = test::documentOf(out);
  EXPECT_EQ(after["buffers"].size(), 1U);
  EXPECT_FALSE(after["images"][0].contains("uri"));
  EXPECT_EQ(after["images"][0]["mimeType"], "image/png");
  EXPECT_EQ(after["images"][1]["uri"], "gone.png");
  ASSERT_EQ(trip.notes.size(), 1U);
  EXPECT_TRUE(test::has(trip.notes[0], "gone.png"));
}

TEST(CharacterClip, OfTheMannequinIsWhole) {
  const test::TemporaryFolder folder;
  const Character mannequin = makeMannequin();
  CharacterFile file;
  file.nodeOfJoint.assign(mannequin.skeleton.joints().size(), 0);
  file.character.skeleton = mannequin.skeleton;
  const SkeletalMotion motion = test::randomMotion(file, 5, 3);
  const fs::path out = folder.path() / "mannequin.glb";
  ASSERT_TRUE(writeClip(out, mannequin, motion).ok());
  const CharacterFile read = test::valueOf(readCharacterFile(out));
  EXPECT_TRUE(read.notes.empty()) << read.notes.front();
  EXPECT_LT(test::farthestFrom(read, mannequin, motion), kTolerance);
}

TEST(CharacterClip, AMotionThatStandsStillIsAnAnimationToo) {
  const test::TemporaryFolder folder;
  const fs::path from = folder.write("hero.glb", test::smallCharacter().glb());
  const CharacterFile file = test::valueOf(readCharacterFile(from));
  const Pose rest = restPose(file.character.skeleton);
  const fs::path out = folder.path() / "stand.glb";
  ASSERT_TRUE(writeClip(out, {from, &file}, {"stand", file.character.skeleton, {0.0}, rest}).ok());
  const CharacterFile read = test::valueOf(readCharacterFile(out));
  EXPECT_EQ(read.clips.front().name, "stand");
}

TEST(CharacterClip, OfAPosedFileHoldsWhatDiffersFromItsNodes) {
  const test::TemporaryFolder folder;
  GlbWriter hero = test::smallCharacter();
  hero.document["nodes"][1]["rotation"] = {0.6, 0.0, 0.0, 0.8};
  hero.document.erase("animations");
  const fs::path from = folder.write("hero.glb", hero.glb());
  const CharacterFile file = test::valueOf(readCharacterFile(from));
  // At rest, as it was bound: the upper bone is not turned.
  const Skeleton& skeleton = file.character.skeleton;
  const SkeletalMotion stands{"stand", skeleton, {0.0}, restPose(skeleton)};
  const fs::path out = folder.path() / "stand.glb";
  ASSERT_TRUE(writeClip(out, {from, &file}, stands).ok());
  const json channels = test::documentOf(out)["animations"][0]["channels"];
  ASSERT_EQ(channels.size(), 1U);
  EXPECT_EQ(channels[0]["target"], (json{{"node", 1}, {"path", "rotation"}}));
  const CharacterFile read = test::valueOf(readCharacterFile(out));
  EXPECT_LT(test::farthestFrom(read, file.character, stands), kTolerance);
}

/// Expects that nothing is written, and these words in the message.
void expectRefused(const GlbWriter& hero, const std::function<void(SkeletalMotion&)>& spoil,
                   const std::vector<std::string>& words) {
  const test::TemporaryFolder folder;
  const fs::path from = folder.write("hero.glb", hero.glb());
  const CharacterFile file = test::valueOf(readCharacterFile(from));
  SkeletalMotion motion = test::randomMotion(file, 3, 1);
  spoil(motion);
  const fs::path out = folder.path() / "walk.glb";
  const Result<std::vector<std::string>> written = writeClip(out, {from, &file}, motion);
  ASSERT_FALSE(written.ok());
  for (const std::string& word : words) {
    EXPECT_TRUE(test::has(written.error().message, word)) << "no ";
  }
  EXPECT_FALSE(fs::exists(out));
}

TEST(CharacterClip, PosesThatAreNotFiniteAreRefusedWithFrameAndJoint) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::string> words = {"walk.glb", "frame 3", "'upper'", "not finite"};
  const auto upper = [](SkeletalMotion& m) -> JointTransform& { return m.poses[2 * m.skeleton.joints().size() + 2]; };
  expectRefused(
      test::smallCharacter(), [&](SkeletalMotion& m) { upper(m).rotation.x() = kNan; }, words);
  expectRefused(
      test::smallCharacter(), [&](SkeletalMotion& m) { upper(m).translation.y() = kNan; }, words);
  expectRefused(
      test::smallCharacter(), [&](SkeletalMotion& m) { upper(m).scale.z() = 1e300; }, words);
}

TEST(CharacterClip, ShearedNodesThatMoveAreRefusedWithTheirName) {
  GlbWriter hero = test::smallCharacter();
  hero.document["nodes"][1].erase("translation");
  hero.document["nodes"][1]["matrix"] = {1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1};
  expectRefused(hero, [](SkeletalMotion&) {}, {"walk.glb", "'upper'", "sheared"});
}

TEST(CharacterClip, FoldersThatAreNotThereAreNamed) {
  const test::TemporaryFolder folder;
  const fs::path from = folder.write("hero.glb", test::smallCharacter().glb());
  const CharacterFile file = test::valueOf(readCharacterFile(from));
  const fs::path out = folder.path() / "nowhere" / "walk.glb";
  EXPECT_TRUE(
      test::has(test::errorOf(writeClip(out, {from, &file}, test::randomMotion(file, 3, 1))).message, "nowhere"));
}

// Clips on characters that others made, read back: joints and vertices are where they were.

class SharedClips : public testing::TestWithParam<const char*> {};

TEST_P(SharedClips, GoRound) {
  LORICA_REQUIRE_DATASET(from, std::string("characters/") + GetParam());
  const CharacterFile file = test::valueOf(readCharacterFile(from));
  const SkeletalMotion motion = test::randomMotion(file, 4, 11);
  const test::TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "clip.glb";
  const std::vector<std::string> notes = test::valueOf(writeClip(out, {from, &file}, motion));
  const CharacterFile read = test::valueOf(readCharacterFile(out));
  const double farthest = test::farthestFrom(read, file.character, motion);
  EXPECT_LT(farthest, 1e-5 * std::max(file.character.height, 1.0));
  EXPECT_EQ(read.look.groups.size(), file.look.groups.size());
  EXPECT_EQ(read.look.materials.size(), file.look.materials.size());
  std::printf("%s: joints and vertices within %.2g m\n", GetParam(), farthest);
}

INSTANTIATE_TEST_SUITE_P(, SharedClips,
                         testing::Values("arnaud/arnaud.fbx", "cesiumman/CesiumMan.glb", "fox/Fox.glb",
                                         "godette/Godette_vrm_v4.vrm", "greenman/greenman.glb", "kaykit/Barbarian.glb",
                                         "kaykit/Mage.glb", "raylib_robot/robot.glb"),
                         [](const auto& each) {
                           const std::string path = each.param;
                           return path.substr(0, path.find('/')) + std::to_string(each.index);
                         });

}  // namespace
}  // namespace lorica::test
