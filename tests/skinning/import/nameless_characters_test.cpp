// The shared characters with their names replaced by numbers: what the shape alone finds, against what the names say.

#include "skinning/humanoid/humanoid.h"
#include "skinning/import/character_file.h"
#include "tests/skinning/humanoid/humanoid_samples.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

using test::isDoubted;
using enum HumanBone;

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

}  // namespace
}  // namespace lorica
