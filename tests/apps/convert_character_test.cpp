// `lorica convert MOTION OUT --character HERO`: the motion on the user's own joints.
#include "capture/files/bvh_file.h"
#include "geometry/files.h"
#include "skinning/import/character_file.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/apps/refusals.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

std::string at(const TemporaryFolder& folder, const char* name) {
  return folder.path() / name;
}

using Positions = std::map<std::string, Vec3>;

Positions positionsOf(const Skeleton& skeleton, std::span<const JointTransform> pose) {
  std::vector<Affine3> worldFromJoint(pose.size());
  computeWorldFromJoint(skeleton, pose, worldFromJoint);
  Positions positions;
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    std::string name = skeleton.joint(j).name;
    std::replace(name.begin(), name.end(), ' ', '_');  // as in BVH
    positions[name] = worldFromJoint[j].translation();
  }
  return positions;
}

/// Converts a motion to a .glb and a .bvh of a character: both have its joints at the same places.
void expectSameJoints(const std::string& motion, bool torn, bool named, const std::vector<std::string>& options = {}) {
  const TemporaryFolder folder;
  const std::string hero = folder.write("hero.glb", mannequinGlb(torn, named));
  for (const char* out : {"walk.glb", "walk.bvh"}) {
    std::vector<std::string> arguments = {"convert", "--force", motion, at(folder, out), "--character", hero};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.insert(arguments.end(), {"--json", "-"});
    const CommandResult result = runLorica(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.json()["character"], hero);
    EXPECT_GE(result.json()["joints"].get<int>(), 52);
  }
  const CharacterFile before = readCharacterFile(hero).value();
  const CharacterFile glb = readCharacterFile(at(folder, "walk.glb")).value();
  const SkeletalMotion bvh = readBvh(at(folder, "walk.bvh")).value().motion;
  ASSERT_EQ(glb.clips.size(), before.clips.size() + 1);
  EXPECT_EQ(glb.character.mesh.vertices, before.character.mesh.vertices);
  EXPECT_NEAR(glb.clips.front().seconds, bvh.times.back() - bvh.times.front(), 1e-3);
  double moved = 0.0;
  for (int f = 0; f < bvh.frameCount(); f += 11) {
    Pose pose = restPose(glb.character.skeleton);
    const Positions atRest = positionsOf(glb.character.skeleton, pose);
    sampleClip(glb.clips.front(), bvh.times[f] - bvh.times.front(), pose);
    const Positions inGlb = positionsOf(glb.character.skeleton, pose);
    for (const auto& [name, position] : positionsOf(bvh.skeleton, bvh.pose(f))) {
      ASSERT_TRUE(inGlb.contains(name)) << name;
      EXPECT_LT((inGlb.at(name) - position).norm(), 1e-5) << name << ", frame " << f;
      moved = std::max(moved, (position - atRest.at(name)).norm());
    }
  }
  EXPECT_GT(moved, 0.3);
}

TEST(ConvertCharacter, JointsAreAtTheSamePlacesInGlbAndBvh) {
  expectSameJoints("walk", false, true);
}

TEST(ConvertCharacter, TornCharactersInCentimetresToo) {
  expectSameJoints("wave", true, false, {"--mirror"});
}

TEST(ConvertCharacter, DepthRecordingsAreASourceToo) {
  expectSameJoints("wave_depth", false, true, {"--smooth", "one-euro"});
}

TEST(ConvertCharacter, TheMannequinIsACharacter) {
  const TemporaryFolder folder;
  ASSERT_EQ(runLorica({"convert", "walk", at(folder, "walk.glb"), "--character", "mannequin"}).exitCode, 0);
  const CharacterFile made = readCharacterFile(at(folder, "walk.glb")).value();
  EXPECT_EQ(made.clips.size(), 1U);
  EXPECT_EQ(made.clips.front().name, "walk");
}

TEST(ConvertCharacter, WhatCannotBeIsRefusedInASentence) {
  const TemporaryFolder folder;
  const std::string hero = mannequinGlb(false);
  (void)folder.write("hero.glb", hero);
  expectRefused(folder, {"convert", "walk", "hero.glb", "--character", "hero.glb"}, {"hero.glb", "overwritten"});
  EXPECT_EQ(readFile(folder.path() / "hero.glb").value(), hero);
  expectRefused(folder, {"convert", "walk", "walk.glb"}, {"walk.glb", "--character"});
  expectRefused(folder, {"convert", "walk", "walk.csv", "--character", "hero.glb"}, {".csv", ".glb", ".bvh"});
  expectRefused(folder, {"convert", "walk", "walk.fbx", "--character", "hero.glb"}, {".fbx", ".glb", ".bvh"});
  expectRefused(folder, {"convert", "walk", "walk.glb", "--character", "hero.obj"}, {"hero.obj", ".vrm", "mannequin"});
  expectRefused(folder, {"convert", "walk", "walk.glb", "--character", "gone.glb"}, {"gone.glb"});
  expectRefused(folder, {"convert", "walk", "walk.bvh", "--map", "hero.json"}, {"--map", "--character"});
  expectRefused(folder, {"convert", "walk", "no/walk.glb", "--character", "hero.glb"}, {"no"});
  expectRefused(folder, {"convert", "wave_depth", "x.csv", "--camera-frame", "--character", "hero.glb"},
                {"x.csv", ".glb or .bvh"});
  // A mesh, and joints of nobody.
  GlbWriter box = smallCharacter();
  (void)folder.write("joints.glb", box.glb());
  box.document.erase("skins");
  box.document.erase("animations");
  box.document["nodes"][2].erase("skin");
  (void)folder.write("box.glb", box.glb());
  expectRefused(folder, {"convert", "walk", "walk.glb", "--character", "box.glb"}, {"box", "hips"});
  expectRefused(folder, {"convert", "walk", "walk.glb", "--character", "joints.glb"}, {"joints", "hips"});
}

}  // namespace
}  // namespace lorica::test
