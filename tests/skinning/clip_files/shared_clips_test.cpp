// Clips on characters that others made, read back: joints and vertices are where they were.
#include "skinning/clip_files/character_clip.h"
#include "tests/skinning/clip_files/clip_samples.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

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
}  // namespace lorica
