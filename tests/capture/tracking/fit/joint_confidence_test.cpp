#include "capture/tracking/fit/joint_confidence.h"

#include "capture/tracking/fit/limb_pose.h"

#include <gtest/gtest.h>

namespace lorica::fit {
namespace {

using J = BodyJoint;

CapsuleSupport allSeen() {
  CapsuleSupport support;
  support.seen.fill(1.5F);
  return support;
}

void hide(Limb limb, CapsuleSupport& support) {
  for (std::size_t c = 0; c < kCapsuleCount; ++c) {
    if (isOf(limb, capsuleDefs()[c].node)) support.hidden[c] = 1.0F;
  }
}

JointConfidence after(const CapsuleSupport& support, int views) {
  JointConfidence confidence;
  confidence.restart();
  for (int i = 0; i < views; ++i) confidence.update(support, false);
  return confidence;
}

TEST(JointConfidence, WhatIsSeenIsSureAfterAFewViews) {
  const JointConfidence first = after(allSeen(), 1), later = after(allSeen(), 6);
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    EXPECT_LT(first[static_cast<J>(j)], 0.5) << nameOf(static_cast<J>(j));
    EXPECT_GE(later[static_cast<J>(j)], 0.5) << nameOf(static_cast<J>(j));
  }
}

TEST(JointConfidence, ALegBehindFurnitureIsUnsureThoughTheHipsAreSeen) {
  CapsuleSupport support = allSeen();
  hide(kLeftLeg, support);
  const JointConfidence confidence = after(support, 6);
  for (const J joint : {J::kLeftHip, J::kLeftKnee, J::kLeftFoot}) EXPECT_LT(confidence[joint], 0.5) << nameOf(joint);
  for (const J joint : {J::kRightHip, J::kRightKnee, J::kRightFoot, J::kTorso, J::kLeftHand}) {
    EXPECT_GE(confidence[joint], 0.5) << nameOf(joint);
  }
}

TEST(JointConfidence, HipAndKneeAreUnsureWhereSomethingHidesTheSideOfTheTrunk) {
  CapsuleSupport support = allSeen();
  support.hiddenSide[0] = 1.0F;
  const JointConfidence confidence = after(support, 6);
  for (const J joint : {J::kLeftHip, J::kLeftKnee}) EXPECT_LT(confidence[joint], 0.5) << nameOf(joint);
  for (const J joint : {J::kRightHip, J::kRightKnee, J::kLeftFoot, J::kTorso}) {
    EXPECT_GE(confidence[joint], 0.5) << nameOf(joint);
  }
}

TEST(JointConfidence, AnArmBehindSomeoneElseIsUnsure) {
  CapsuleSupport support = allSeen();
  hide(kRightArm, support);
  const JointConfidence confidence = after(support, 6);
  for (const J joint : {J::kRightElbow, J::kRightHand}) EXPECT_LT(confidence[joint], 0.5) << nameOf(joint);
  for (const J joint : {J::kLeftElbow, J::kLeftHand, J::kRightFoot}) EXPECT_GE(confidence[joint], 0.5) << nameOf(joint);
}

}  // namespace
}  // namespace lorica::fit
