#include "skinning/body/limbs.h"

#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(Limbs, TellWhatTouchesFromWhatBends) {
  const Character mannequin = makeMannequin();
  const Limbs limbs(mannequin);
  const auto joint = [&](HumanBone bone) { return mannequin.skeleton.jointOf(bone); };
  const auto positionOf = [&](HumanBone bone) -> Vec3 {
    return mannequin.jointFromModel[joint(bone)].inverse().translation();
  };
  const JointIndex leftThigh = joint(HumanBone::kLeftUpperLeg), rightThigh = joint(HumanBone::kRightUpperLeg);
  const JointIndex leftShin = joint(HumanBone::kLeftLowerLeg), forearm = joint(HumanBone::kLeftLowerArm);
  const Vec3 crotch = positionOf(HumanBone::kHips) - Vec3(0, 0.12, 0);
  const Vec3 knees = 0.5 * (positionOf(HumanBone::kLeftLowerLeg) + positionOf(HumanBone::kRightLowerLeg));
  for (int turn = 0; turn < 2; ++turn) {
    const auto apart = [&](JointIndex a, JointIndex b, const Vec3& at) {
      return turn == 0 ? limbs.apart(a, b, at) : limbs.apart(b, a, at);
    };
    EXPECT_FALSE(apart(leftThigh, rightThigh, crotch));
    EXPECT_TRUE(apart(leftThigh, rightThigh, knees));
    EXPECT_TRUE(apart(leftShin, rightThigh, knees));
    EXPECT_FALSE(apart(leftThigh, leftShin, positionOf(HumanBone::kLeftLowerLeg)));
    EXPECT_FALSE(apart(joint(HumanBone::kHips), leftThigh, positionOf(HumanBone::kLeftUpperLeg)));
    EXPECT_FALSE(apart(joint(HumanBone::kSpine), leftThigh, positionOf(HumanBone::kHips) + Vec3(0.15, 0, 0)));
    EXPECT_FALSE(apart(joint(HumanBone::kHips), joint(HumanBone::kChest), positionOf(HumanBone::kSpine)));
    EXPECT_TRUE(apart(forearm, joint(HumanBone::kChest), positionOf(HumanBone::kChest)));
    EXPECT_TRUE(apart(joint(HumanBone::kLeftHand), leftThigh, positionOf(HumanBone::kLeftUpperLeg) - Vec3(0, 0.4, 0)));
    EXPECT_TRUE(apart(joint(HumanBone::kLeftHand), joint(HumanBone::kRightHand), positionOf(HumanBone::kChest)));
    EXPECT_FALSE(
        apart(joint(HumanBone::kLeftUpperArm), joint(HumanBone::kChest), positionOf(HumanBone::kLeftUpperArm)));
    EXPECT_FALSE(apart(leftThigh, leftThigh, knees));
  }
  EXPECT_TRUE(limbs.onOneBranch(joint(HumanBone::kHips), leftShin));
  EXPECT_TRUE(limbs.onOneBranch(leftShin, joint(HumanBone::kHips)));
  EXPECT_FALSE(limbs.onOneBranch(leftThigh, rightThigh));
  EXPECT_FALSE(limbs.onOneBranch(leftShin, rightThigh));
}

}  // namespace
}  // namespace lorica
