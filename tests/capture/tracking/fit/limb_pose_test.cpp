#include "capture/tracking/fit/limb_pose.h"

#include <gtest/gtest.h>

namespace lorica::fit {
namespace {

TEST(LimbPose, AReachingLimbEndsAtItsTarget) {
  const V3 origin(0.2F, 1.4F, 0.0F);
  const V3 target(0.35F, 1.2F, 0.3F);
  const LimbLine line = reachFor(origin, 0.29F, 0.25F, target, -V3::UnitY());
  EXPECT_LT((origin + 0.29F * line.upper + 0.25F * line.lower - target).norm(), 1e-5F);
  EXPECT_LT(line.upper.y(), (target - origin).normalized().y());  // the elbow is on the pole's side
}

TEST(LimbPose, TargetsOutOfReachArePointedAt) {
  const LimbLine line = reachFor(V3::Zero(), 0.3F, 0.25F, {0.0F, 0.0F, 2.0F}, V3::UnitX());
  EXPECT_GT(line.upper.z(), 0.99F);
  EXPECT_GT(line.lower.z(), 0.99F);
}

TEST(LimbPose, LaidLimbsPointAlongTheirDirections) {
  const BodyPose start = standingPose({0.1F, 0.9F, -0.2F}, 0.7F, 0.3F, 0.2F, 0.4F);
  PosedModel body;
  poseBody(start, Proportions(), body);
  for (const Limb limb : {kLeftArm, kRightArm, kLeftLeg, kRightLeg}) {
    const V3 upper = body.rotation[kPelvis] * V3(0.2F, -0.9F, 0.35F).normalized();
    const bool arm = limb == kLeftArm || limb == kRightArm;
    const V3 lower = body.rotation[kPelvis] * V3(0.1F, -0.6F, arm ? 0.8F : -0.4F).normalized();
    BodyPose pose = start;
    layLimb(limb, body, upper, lower, pose);
    PosedModel laid;
    poseBody(pose, Proportions(), laid);
    const V3 first = (laid.position[lowerNodeOf(limb)] - laid.position[upperNodeOf(limb)]).normalized();
    const V3 second = (laid.position[endNodeOf(limb)] - laid.position[lowerNodeOf(limb)]).normalized();
    // The mannequin's bones deviate from its axes: elbows and knees by a degree or two, shins by five.
    EXPECT_GT(first.dot(upper), 0.995F) << int{limb};
    EXPECT_GT(second.dot(lower), 0.985F) << int{limb};
  }
}

TEST(LimbPose, TurnedAboutKeepsHandsAndFeetAndFacesAway) {
  const BodyPose pose = standingPose({0.0F, 0.915F, 0.0F}, 0.0F, 0.4F, 0.1F, 0.3F);
  const BodyPose turned = turnedAbout(pose, Proportions());
  PosedModel a, b;
  poseBody(pose, Proportions(), a);
  poseBody(turned, Proportions(), b);
  EXPECT_LT(a.rotation[kPelvis].col(2).dot(b.rotation[kPelvis].col(2)), -0.99F);
  EXPECT_LT((a.position[kLeftHand] - b.position[kRightHand]).norm(), 0.06F);
  EXPECT_LT((a.position[kLeftFoot] - b.position[kRightFoot]).norm(), 0.06F);
}

}  // namespace
}  // namespace lorica::fit
