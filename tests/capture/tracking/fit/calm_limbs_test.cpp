#include "capture/tracking/fit/calm_limbs.h"

#include "capture/skeleton_frame.h"
#include "capture/tracking/fit/body_fit.h"
#include "capture/tracking/fit/body_model.h"
#include "capture/tracking/fit/joint_confidence.h"
#include "capture/tracking/fit/limb_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace lorica::fit {
namespace {

constexpr float kFrame = 1.0F / 30.0F;  // [s]
constexpr float kPi = 3.14159265F;

JointConfidence confidenceOf(float seen) {
  CapsuleSupport support;
  support.seen.fill(seen);
  JointConfidence confidence;
  confidence.restart();
  for (int view = 0; view < 6; ++view) confidence.update(support, false);
  return confidence;
}

/// Both arms at an angle from hanging, forwards [rad].
BodyPose armsAt(float forward, float heading = 0.0F) {
  return standingPose(V3(0.0F, 0.9F, -2.0F), heading, 0.1F, forward, 0.3F);
}

PosedModel posed(const BodyPose& pose) {
  PosedModel body;
  poseBody(pose, Proportions(), body);
  return body;
}

/// The farthest that an elbow or wrist moves against its shoulder [m].
float moveOfArms(const BodyPose& from, const BodyPose& to) {
  const PosedModel a = posed(from), b = posed(to);
  float farthest = 0.0F;
  for (const auto& [shoulder, elbow, wrist] :
       {std::array{kLeftUpperArm, kLeftForearm, kLeftHand}, std::array{kRightUpperArm, kRightForearm, kRightHand}}) {
    for (const Node node : {elbow, wrist}) {
      const V3 before = a.position[node] - a.position[shoulder], now = b.position[node] - b.position[shoulder];
      farthest = std::max(farthest, (now - before).norm());
    }
  }
  return farthest;
}

TEST(CalmLimbs, WhatIsSeenIsShownWhereItIsHoweverFastItMoves) {
  const JointConfidence seen = confidenceOf(9.0F);
  CalmLimbs calm;
  // A punch: from rest to 8 m/s within four frames.
  float angle = 0.0F;
  for (const float step : {0.0F, 0.0F, 0.15F, 0.3F, 0.5F, 0.5F, 0.3F, 0.0F}) {
    angle += step;
    calm.update(armsAt(angle), Proportions(), seen, kFrame);
    EXPECT_LT(moveOfArms(armsAt(angle), calm.pose()), 1e-6F) << angle;
  }
}

TEST(CalmLimbs, AGuessedArmMovesNoFasterThanPeopleMoveTheirs) {
  const JointConfidence guessed = confidenceOf(0.0F);
  CalmLimbs calm;
  calm.update(armsAt(0.0F), Proportions(), guessed, kFrame);
  for (int frame = 1; frame < 30; ++frame) {
    const BodyPose before = calm.pose();
    // Fitted elsewhere in each view, and the whole body turns about in one of them.
    const BodyPose fitted = armsAt(frame % 2 == 1 ? 2.5F : -0.4F, frame < 15 ? 0.0F : kPi);
    calm.update(fitted, Proportions(), guessed, kFrame);
    EXPECT_LT(moveOfArms(before, calm.pose()), 0.11F) << frame;
    SkeletonFrame shown;
    for (TrackedJoint& joint : shown.joints) joint.confidence = 1.0;
    calm.doubt(shown);
    // Once the trunk has turned, the arm is back where it was in every other view.
    if (frame < 15 || frame % 2 == 1) {
      EXPECT_LT(shown[BodyJoint::kLeftHand].confidence, 0.5) << frame;
    }
    EXPECT_EQ(shown[BodyJoint::kHead].confidence, 1.0) << frame;
  }
}

/// The farthest that head, shoulders and hips move [m].
float moveOfTrunk(const BodyPose& from, const BodyPose& to) {
  const PosedModel a = posed(from), b = posed(to);
  float farthest = (headOf(b) - headOf(a)).norm();
  for (const Node node : {kLeftUpperArm, kRightUpperArm, kLeftThigh, kRightThigh}) {
    farthest = std::max(farthest, (b.position[node] - a.position[node]).norm());
  }
  return farthest;
}

TEST(CalmLimbs, ATrunkThatMovesAsPeopleDoIsShownWhereItIs) {
  const JointConfidence seen = confidenceOf(9.0F);
  CalmLimbs calm;
  BodyPose pose = armsAt(0.0F);
  // A jump to the side: from rest to 4.5 m/s within four frames.
  for (const float step : {0.0F, 0.0F, 0.03F, 0.07F, 0.11F, 0.15F, 0.15F, 0.05F}) {
    pose.root.x() += step;
    calm.update(pose, Proportions(), seen, kFrame);
    EXPECT_LT(moveOfTrunk(pose, calm.pose()), 1e-6F) << step;
  }
}

TEST(CalmLimbs, ATrunkThatIsFittedElsewhereIsShownOnTheWayThere) {
  const JointConfidence seen = confidenceOf(9.0F);
  CalmLimbs calm;
  calm.update(armsAt(0.0F), Proportions(), seen, kFrame);
  BodyPose leaning = armsAt(0.0F);
  leaning.turn[kPelvis] = leaning.turn[kPelvis] * Q(Eigen::AngleAxisf(0.3F, V3::UnitX()));
  const BodyPose before = calm.pose();
  ASSERT_GT(moveOfTrunk(before, leaning), 0.15F);
  calm.update(leaning, Proportions(), seen, kFrame);
  EXPECT_LT(moveOfTrunk(before, calm.pose()), 0.09F);
  EXPECT_GT(moveOfTrunk(before, calm.pose()), 0.06F);
  calm.update(leaning, Proportions(), seen, kFrame);
  calm.update(leaning, Proportions(), seen, kFrame);
  EXPECT_LT(moveOfTrunk(leaning, calm.pose()), 1e-6F);
}

TEST(CalmLimbs, AFloorThatIsFoundLaterIsNoMovement) {
  const JointConfidence seen = confidenceOf(9.0F);
  CalmLimbs calm;
  BodyPose pose = armsAt(0.0F);
  calm.update(pose, Proportions(), seen, kFrame);
  Eigen::Isometry3f newFromOld(Eigen::AngleAxisf(0.2F, V3::UnitX()));
  newFromOld.translation() = V3(0.0F, 0.5F, 0.1F);
  calm.move(newFromOld);
  pose.root = newFromOld * pose.root;
  pose.turn[kPelvis] = Q(newFromOld.linear()) * pose.turn[kPelvis];
  calm.update(pose, Proportions(), seen, kFrame);
  EXPECT_LT(moveOfTrunk(pose, calm.pose()), 1e-6F);
}

TEST(CalmLimbs, AnArmThatIsSeenAgainArrivesAndIsSureFromThenOn) {
  const JointConfidence guessed = confidenceOf(0.0F), seen = confidenceOf(9.0F);
  CalmLimbs calm;
  calm.update(armsAt(0.0F), Proportions(), guessed, kFrame);
  const BodyPose up = armsAt(2.5F);
  const auto isSure = [&] {
    SkeletonFrame shown;
    for (TrackedJoint& joint : shown.joints) joint.confidence = 1.0;
    calm.doubt(shown);
    return shown[BodyJoint::kLeftHand].confidence >= 0.5;
  };
  int frames = 0;
  do {
    calm.update(up, Proportions(), seen, kFrame);
    EXPECT_EQ(isSure(), moveOfArms(up, calm.pose()) <= 0.03F);
  } while (!isSure() && ++frames < 30);
  // 0.9 m of chord along an arc of 1.2 m, at 3.5 m/s.
  EXPECT_GE(frames, 6);
  EXPECT_LE(frames, 12);
}

TEST(CalmLimbs, AfterALongPauseThePoseIsShownAsItIs) {
  const JointConfidence guessed = confidenceOf(0.0F);
  CalmLimbs calm;
  calm.update(armsAt(0.0F), Proportions(), guessed, kFrame);
  calm.update(armsAt(2.5F), Proportions(), guessed, 0.5F);
  EXPECT_LT(moveOfArms(armsAt(2.5F), calm.pose()), 1e-6F);
  calm.restart();
  calm.update(armsAt(0.0F), Proportions(), guessed, kFrame);
  EXPECT_LT(moveOfArms(armsAt(0.0F), calm.pose()), 1e-6F);
}

}  // namespace
}  // namespace lorica::fit
