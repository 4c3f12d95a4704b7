#include "skinning/clip_files/character_clip.h"
#include "tests/skinning/clip_files/clip_samples.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using test::GlbWriter;

/// Expects that nothing is written, and these words in the message.
void expectRefused(const GlbWriter& hero, const std::function<void(SkeletalMotion&)>& spoil,
                   const std::vector<std::string>& words) {
  const test::TemporaryFolder folder;
  const fs::path from = folder.write("hero.glb", hero.glb());
  const Result<CharacterFile> file = readCharacterFile(from);
  ASSERT_TRUE(file.ok()) << file.error().message;
  SkeletalMotion motion = test::randomMotion(*file, 3, 1);
  spoil(motion);
  const fs::path out = folder.path() / "walk.glb";
  const Result<std::vector<std::string>> written = writeClip(out, {from, &*file}, motion);
  ASSERT_FALSE(written.ok());
  for (const std::string& word : words) {
    EXPECT_NE(written.error().message.find(word), std::string::npos)
        << "no " << word << " in: " << written.error().message;
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
  const Result<CharacterFile> file = readCharacterFile(from);
  ASSERT_TRUE(file.ok());
  const fs::path out = folder.path() / "nowhere" / "walk.glb";
  const Result<std::vector<std::string>> written = writeClip(out, {from, &*file}, test::randomMotion(*file, 3, 1));
  ASSERT_FALSE(written.ok());
  EXPECT_NE(written.error().message.find("nowhere"), std::string::npos);
}

}  // namespace
}  // namespace lorica
