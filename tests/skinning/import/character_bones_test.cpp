#include "skinning/humanoid/humanoid.h"
#include "skinning/import/character_file.h"
#include "tests/skinning/humanoid/humanoid_samples.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace lorica {
namespace {

using test::contradictions;
using test::differences;
using test::namesOf;
using test::RigNames;
using enum HumanBone;

void expectBones(const std::filesystem::path& file, const std::map<HumanBone, std::string>& truth,
                 std::string_view by) {
  const Skeleton skeleton = test::valueOf(readCharacterFile(file)).character.skeleton;
  const HumanoidGuess guess = guessHumanoid(test::withoutBones(skeleton));
  EXPECT_EQ(differences(truth, namesOf(skeleton, guess)), "") << file;
  EXPECT_EQ(contradictions(skeleton, guess), "") << file;
  EXPECT_EQ(guess.by, by) << file;
  for (int bone = 0; bone < kHumanBoneCount; ++bone) {
    EXPECT_EQ(skeleton.jointOf(static_cast<HumanBone>(bone)), guess[static_cast<HumanBone>(bone)])
        << file << ": reading marks the bones, " << nameOf(static_cast<HumanBone>(bone));
  }
}

TEST(CharacterBones, CesiumMan) {
  LORICA_REQUIRE_DATASET(file, "characters/cesiumman/CesiumMan.glb");
  // Numbered chains with different numbers left and right: no convention, so the shape is used, and the names for
  // sides.
  const RigNames rig = test::rigOf(
      "", "", "L,R",
      "Skeleton_torso_joint_1,Skeleton_torso_joint_2,torso_joint_3,,Skeleton_neck_joint_1,Skeleton_neck_joint_2",
      "leg_joint_%_1,leg_joint_%_2,leg_joint_%_3,leg_joint_%_5", ",,,");
  std::map<HumanBone, std::string> truth = namesOf(rig);
  truth[kLeftUpperArm] = "Skeleton_arm_joint_L__4_";
  truth[kLeftLowerArm] = "Skeleton_arm_joint_L__3_";
  truth[kLeftHand] = "Skeleton_arm_joint_L__2_";
  truth[kRightUpperArm] = "Skeleton_arm_joint_R";
  truth[kRightLowerArm] = "Skeleton_arm_joint_R__2_";
  truth[kRightHand] = "Skeleton_arm_joint_R__3_";
  expectBones(file, truth, "the skeleton's shape");
}

TEST(CharacterBones, ArnaudAndHisClipFiles) {
  // the thighs are below Spine
  const RigNames rig =
      test::rigOf("", "", "Left,Right", "Hips,Spine1,Spine2,Spine3,Neck,Head", "%UpLeg,%Leg,%Foot,%FootThumb1",
                  "%Shoulder,%Arm,%ForeArm,%Hand", "%Hand@#", "Thumb,Index,Middle,Ring,Pinky");
  std::map<HumanBone, std::string> truth = namesOf(rig);
  truth[kLeftHand] = "Lefthand";  // as the artist wrote it
  truth[kLeftLittleProximal] = "LeftHandRingPinky1";
  truth[kLeftLittleIntermediate] = "LeftHandRingPinky2";
  truth[kLeftLittleDistal] = "LeftHandRingPinky3";
  for (const char* name : {"arnaud", "walk", "run", "crossarms", "atlas"}) {
    LORICA_REQUIRE_DATASET(file, std::string("characters/arnaud/") + name + ".fbx");
    expectBones(file, truth, "names (Mixamo)");
  }
}

TEST(CharacterBones, KayKit) {
  const RigNames rig = test::rigOf("", "", "l,r", "hips,spine,chest,,,head", "upperleg.%,lowerleg.%,foot.%,toes.%",
                                   ",upperarm.%,lowerarm.%,wrist.%");
  for (const char* name : {"Barbarian", "Mage"}) {
    LORICA_REQUIRE_DATASET(file, std::string("characters/kaykit/") + name + ".glb");
    expectBones(file, namesOf(rig), "names (KayKit)");
  }
}

TEST(CharacterBones, RaylibRobot) {
  LORICA_REQUIRE_DATASET(file, "characters/raylib_robot/robot.glb");
  // Its feet are below the root and its thumbs below the forearms: joints not below the limb are not its bones. Hips is
  // only a joint of the trunk: Body carries trunk and legs.
  const RigNames rig = test::rigOf("", "", "L,R", "Body,Abdomen,Torso,,Neck,Head", "UpperLeg.%,LowerLeg.%,,",
                                   "Shoulder.%,UpperArm.%,LowerArm.%,Palm2.%");
  std::map<HumanBone, std::string> truth = namesOf(rig);
  truth[kLeftMiddleProximal] = "Middle1.L";
  truth[kLeftMiddleIntermediate] = "Middle2.L";
  truth[kRightMiddleProximal] = "Middle1.R";
  truth[kRightMiddleIntermediate] = "Middle2.R";
  expectBones(file, truth, "names (common words)");
}

TEST(CharacterBones, Greenman) {
  LORICA_REQUIRE_DATASET(file, "characters/greenman/greenman.glb");
  // A puppet: its hip joints lead sideways from the middle to legs of one joint, its hands are its arms.
  const RigNames rig = test::rigOf("", "", "L,R", "root,body_low,,,,body_up", "leg_%,,,", ",hand_%,,");
  expectBones(file, namesOf(rig), "names (common words)");
}

TEST(CharacterBones, TheFoxIsNoHuman) {
  LORICA_REQUIRE_DATASET(file, "characters/fox/Fox.glb");
  expectBones(file, {}, "");
}

// The list in the VRM file was made by its artist: the guess must agree for every bone that it finds.
TEST(CharacterBones, GodetteAsHerOwnListHasHer) {
  LORICA_REQUIRE_DATASET(file, "characters/godette/Godette_vrm_v4.vrm");
  const Skeleton own = test::valueOf(readCharacterFile(file)).character.skeleton;
  const HumanoidGuess guess = guessHumanoid(test::withoutBones(own));
  int found = 0;
  int listed = 0;
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    if (own.jointOf(bone) != kNoJoint) ++listed;
    if (guess[bone] == kNoJoint) continue;
    EXPECT_EQ(guess[bone], own.jointOf(bone)) << nameOf(bone);
    ++found;
  }
  EXPECT_EQ(listed, 45);
  EXPECT_EQ(found, 27) << "all but six fingers, whose names are meaningless";
}

}  // namespace
}  // namespace lorica
