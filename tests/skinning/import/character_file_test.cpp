#include "skinning/import/character_file.h"

#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

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

}  // namespace
}  // namespace lorica
