#include "skinning/clip_files/character_clip.h"

#include "geometry/files.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/clip_files/clip_samples.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::GlbWriter;

constexpr double kTolerance = 1e-5;  // [m]

/// Writes a random motion of a file and reads the result back.
struct RoundTrip {
  CharacterFile file;
  SkeletalMotion motion;
  CharacterFile read;
  std::vector<std::string> notes;
};

RoundTrip roundTrip(const fs::path& from, const fs::path& out) {
  Result<CharacterFile> file = readCharacterFile(from);
  EXPECT_TRUE(file.ok()) << file.error().message;
  RoundTrip trip;
  trip.file = std::move(*file);
  trip.motion = test::randomMotion(trip.file, 20, 7);
  const Result<std::vector<std::string>> notes = writeClip(out, {from, &trip.file}, trip.motion);
  EXPECT_TRUE(notes.ok()) << notes.error().message;
  if (notes) trip.notes = *notes;
  Result<CharacterFile> read = readCharacterFile(out);
  EXPECT_TRUE(read.ok()) << read.error().message;
  trip.read = std::move(*read);
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
  EXPECT_NE(trip.notes[0].find("gone.png"), std::string::npos);
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

}  // namespace
}  // namespace lorica
