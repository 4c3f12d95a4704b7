#include "capture/files/bvh_file.h"
#include "skinning/humanoid/humanoid.h"
#include "tests/skinning/humanoid/humanoid_samples.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

namespace lorica {
namespace {

using test::contradictions;
using test::differences;
using test::namesOf;
using test::RigNames;
using test::rigOf;
using enum HumanBone;

void expectBones(const std::filesystem::path& file, const std::map<HumanBone, std::string>& truth,
                 std::string_view by) {
  const Result<BvhFile> read = readBvh(file);
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Skeleton& skeleton = read->motion.skeleton;
  HumanoidGuess none;
  none.jointOf.fill(kNoJoint);
  const HumanoidGuess guess = guessHumanoid(withBones(skeleton, none));
  EXPECT_EQ(differences(truth, namesOf(skeleton, guess)), "") << file;
  EXPECT_EQ(contradictions(skeleton, guess), "") << file;
  EXPECT_EQ(guess.by, by) << file;
  for (const auto& [bone, name] : truth) {
    ASSERT_NE(skeleton.jointOf(bone), kNoJoint) << file << " " << nameOf(bone);
    EXPECT_EQ(skeleton.joint(skeleton.jointOf(bone)).name, name) << file << ": reading finds them, too";
  }
}

TEST(BvhBones, JumpingJacks) {
  LORICA_REQUIRE_DATASET(file, "bvh/animated_drawings/jumping_jacks.bvh");
  std::map<HumanBone, std::string> truth = namesOf(rigOf("", "", "Left,Right", "Hips,lowerback,Chest,Chest2,Neck,Head",
                                                         "%Hip,%Knee,%Ankle,%Toe", "%Collar,%Shoulder,%Elbow,%Wrist"));
  truth[kLeftThumbMetacarpal] = "LThumb";
  truth[kRightThumbMetacarpal] = "RThumb";
  truth[kLeftMiddleProximal] = "LFingers";
  truth[kRightMiddleProximal] = "RFingers";
  expectBones(file, truth, "names (Biovision)");
}

TEST(BvhBones, Zombie) {
  LORICA_REQUIRE_DATASET(file, "bvh/animated_drawings/zombie.bvh");
  // Of four bones of the spine the third is the middle.
  std::map<HumanBone, std::string> truth =
      namesOf(rigOf("", "", "Left,Right", "Hips,Spine,Spine2,Spine3,Neck,Head", "%UpLeg,%Leg,%Foot,%ToeBase",
                    "%Shoulder,%Arm,%ForeArm,%Hand"));
  truth[kLeftThumbMetacarpal] = "LeftHandThumb1";
  truth[kRightThumbMetacarpal] = "RightHandThumb1";
  expectBones(file, truth, "names (Mixamo)");
}

TEST(BvhBones, MakeHumanTodayAndBefore) {
  const RigNames today =
      rigOf("", "", "L,R", "root,spine05,spine03,spine01,neck01,head", "upperleg01.%,lowerleg01.%,foot.%,toe2-1.%",
            "clavicle.%,upperarm01.%,lowerarm01.%,wrist.%", "finger@-#.%", "1,2,3,4,5");
  // Its Hips joint carries only the legs.
  const RigNames before = rigOf("", "", "L,R", "Root,Spine1,Spine2,Spine3,Neck,Head", "UpLeg_%,LoLeg_%,Foot_%,Toe_%",
                                "Clavicle_%,UpArm_%,LoArm_%,Hand_%", "@#_%", "Thumb,Index,Middle,Ring,Pinky");
  for (const auto& [name, rig] : {std::pair("tpose", today), {"walk1", before}, {"zombieWalk1", before}}) {
    LORICA_REQUIRE_DATASET(file, std::string("bvh/makehuman/") + name + ".bvh");
    expectBones(file, namesOf(rig), "names (MakeHuman)");
  }
}

}  // namespace
}  // namespace lorica
