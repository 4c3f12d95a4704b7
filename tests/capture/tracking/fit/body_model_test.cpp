#include "capture/tracking/fit/body_model.h"

#include "capture/retarget/skeletal_retarget.h"
#include "capture/tracking/fit/body_view.h"
#include "capture/tracking/fit/joint_confidence.h"
#include "capture/tracking/fit/limb_pose.h"
#include "capture/tracking/fit/person_fit.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lorica::fit {
namespace {

using J = BodyJoint;

Step randomStep(RandomNumbers& random, double size) {
  Step step;
  for (int i = 0; i < kDofCount; ++i) step[i] = static_cast<float>(random.between(-size, size));
  return step;
}

/// Straight, in T-pose, with the middle of the hips at the mannequin's.
BodyPose restBody() {
  BodyPose pose;
  pose.root = nodeDefs()[kPelvis].position;
  return pose;
}

TEST(BodyModel, JointsAreTheMannequins) {
  PosedModel body;
  poseBody(restBody(), Proportions(), body);
  SkeletonFrame frame;
  readJoints(body, frame);
  const auto expectAt = [&](BodyJoint joint, HumanBone bone) {
    EXPECT_LT((frame[joint].position - mannequinJoint(bone)).norm(), 1e-5) << nameOf(joint);
    EXPECT_LT(frame[joint].orientation->angularDistance(Quat::Identity()), 1e-5) << nameOf(joint);
  };
  expectAt(BodyJoint::kHead, HumanBone::kHead);
  expectAt(BodyJoint::kNeck, HumanBone::kNeck);
  expectAt(BodyJoint::kLeftShoulder, HumanBone::kLeftUpperArm);
  expectAt(BodyJoint::kRightShoulder, HumanBone::kRightUpperArm);
  expectAt(BodyJoint::kLeftElbow, HumanBone::kLeftLowerArm);
  expectAt(BodyJoint::kRightHand, HumanBone::kRightHand);
  expectAt(BodyJoint::kLeftHip, HumanBone::kLeftUpperLeg);
  expectAt(BodyJoint::kRightKnee, HumanBone::kRightLowerLeg);
  expectAt(BodyJoint::kLeftFoot, HumanBone::kLeftFoot);
  const Vec3 torso = 0.25 * (mannequinJoint(HumanBone::kLeftUpperLeg) + mannequinJoint(HumanBone::kRightUpperLeg)) +
                     0.5 * mannequinJoint(HumanBone::kNeck);
  EXPECT_LT((frame[BodyJoint::kTorso].position - torso).norm(), 1e-5);
}

TEST(BodyModel, CapsulesLieOnTheMannequinsSkin) {
  PosedModel body;
  poseBody(restBody(), Proportions(), body);
  const Character mannequin = makeMannequin();
  double sum = 0.0;
  int far = 0;
  for (const Vec3& vertex : mannequin.mesh.vertices) {
    float nearest = 1.0F;
    for (const ShapedCapsule& capsule : body.capsule) {
      nearest = std::min(nearest, distanceTo(body, capsule, vertex.cast<float>()).distance);
    }
    sum += std::abs(nearest);
    far += std::abs(nearest) > 0.03F ? 1 : 0;
  }
  const auto count = static_cast<double>(mannequin.mesh.vertices.size());
  EXPECT_LT(sum / count, 0.012);
  EXPECT_LT(far / count, 0.08);
}

TEST(BodyModel, TwistsAreTheDerivativesOfPositions) {
  RandomNumbers random(11);
  for (int round = 0; round < 5; ++round) {
    const BodyPose pose = stepped(restBody(), randomStep(random, 0.4));
    PosedModel body;
    poseBody(pose, Proportions(), body);
    const V3 inHand(0.05F, 0.02F, -0.01F);
    const V3 position = body.position[kLeftHand] + body.rotation[kLeftHand] * inHand;
    for (int dof = 0; dof < kDofCount; ++dof) {
      // Does this degree of freedom move the left hand?
      bool carries = false;
      for (int n = kLeftHand; n >= 0; n = nodeDefs()[n].parent) {
        const NodeDef& def = nodeDefs()[n];
        carries = carries || (dof >= def.firstDof && dof < def.firstDof + def.dofCount);
      }
      Step step = Step::Zero();
      step[dof] = 2e-3F;
      PosedModel nudged;
      poseBody(stepped(pose, step), Proportions(), nudged);
      const V3 moved = nudged.position[kLeftHand] + nudged.rotation[kLeftHand] * inHand - position;
      const Twist& twist = body.twist[dof];
      const V3 expected =
          carries ? V3(2e-3F * (twist.turn.cross(V3(position - body.position[kPelvis])) + twist.move)) : V3(V3::Zero());
      // An angle at its limit does not increase further.
      if (moved.norm() < 1e-7F && carries) continue;
      EXPECT_LT((moved - expected).norm(), 2e-5F) << "dof " << dof << " round " << round;
    }
  }
}

TEST(BodyModel, StepBetweenLeadsFromOnePoseToTheOther) {
  RandomNumbers random(5);
  const BodyPose from = stepped(restBody(), randomStep(random, 0.5));
  const BodyPose to = stepped(from, randomStep(random, 0.5));
  PosedModel a, b;
  poseBody(to, Proportions(), a);
  poseBody(stepped(from, stepBetween(from, to)), Proportions(), b);
  for (std::size_t n = 0; n < kNodeCount; ++n) EXPECT_LT((a.position[n] - b.position[n]).norm(), 1e-5F);
}

TEST(BodyModel, DistanceIsZeroOnTheSurfaceAndGrowsAlongTheNormal) {
  RandomNumbers random(3);
  PosedModel body;
  poseBody(stepped(restBody(), randomStep(random, 0.3)), Proportions(), body);
  for (const ShapedCapsule& capsule : body.capsule) {
    const V3 around = V3(static_cast<float>(random.between(-1, 1)), static_cast<float>(random.between(-1, 1)),
                         static_cast<float>(random.between(-1, 1)))
                          .normalized();
    const V3 outside = capsule.middle + 0.5F * around;
    V3 p = outside;
    // Newton's steps along the normal end on the surface.
    for (int i = 0; i < 30; ++i) {
      const SurfaceHit hit = distanceTo(body, capsule, p);
      p -= hit.distance * hit.normal;
    }
    EXPECT_NEAR(distanceTo(body, capsule, p).distance, 0.0F, 1e-4F);
    const SurfaceHit hit = distanceTo(body, capsule, p);
    EXPECT_NEAR(hit.normal.norm(), 1.0F, 1e-4F);
    EXPECT_NEAR(distanceTo(body, capsule, p + 0.002F * hit.normal).distance, 0.002F, 3e-4F);
  }
}

TEST(BodyModel, LengthsScaleTheirLimbsAlone) {
  Proportions proportions;
  proportions.factor[kForearmLength] = 1.2F;
  PosedModel plain, other;
  poseBody(restBody(), Proportions(), plain);
  poseBody(restBody(), proportions, other);
  EXPECT_NEAR((other.position[kLeftHand] - other.position[kLeftForearm]).norm(),
              1.2F * (plain.position[kLeftHand] - plain.position[kLeftForearm]).norm(), 1e-3F);
  EXPECT_LT((other.position[kLeftForearm] - plain.position[kLeftForearm]).norm(), 1e-6F);
  EXPECT_LT((other.position[kRightShin] - plain.position[kRightShin]).norm(), 1e-6F);
}

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

constexpr double kNear = 2000.0, kFar = 3500.0;  // someone before a wall [mm]

/// Somebody 160 pixels wide before a wall, with ramps of a width at both sides instead of steps [pixels].
BodyView viewOf(double ramp) {
  const DepthCamera camera;
  std::vector<std::uint16_t> depth;
  std::vector<std::uint8_t> labels;
  depth.reserve(static_cast<std::size_t>(camera.width) * camera.height);
  labels.reserve(depth.capacity());
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double outside = std::abs(x + 0.5 - 0.5 * camera.width) - 80.0;
      const double share = y < 100 || y >= 400 ? 1.0 : std::clamp(outside / ramp + 0.5, 0.0, 1.0);
      depth.push_back(static_cast<std::uint16_t>(kNear + share * (kFar - kNear)));
      labels.push_back(depth.back() < kFar - 100.0 ? 1 : 0);  // what is nearer than the wall is taken for the person
    }
  }
  BodyView view(camera);
  view.look(depth, labels, 1, Isometry3::Identity());
  return view;
}

float deepest(const BodyView& view) {
  float depth = 0.0F;
  for (const BodyView::Point& point : view.points()) depth = std::max(depth, -point.position.z());
  return depth;
}

TEST(BodyView, AllBlocksOfAPersonWithSharpEdgesArePoints) {
  const BodyView view = viewOf(1.0);
  EXPECT_FALSE(view.blurred());
  EXPECT_EQ(view.points().size(), 160U / 4 * (300 / 4));
  EXPECT_NEAR(deepest(view), 2.0, 1e-3);
}

TEST(BodyView, TheRampsOfBlurredEdgesAreNoPoints) {
  for (const double ramp : {10.0, 14.0, 18.0}) {
    const BodyView view = viewOf(ramp);
    EXPECT_TRUE(view.blurred()) << ramp;
    EXPECT_LT(deepest(view), 2.07) << ramp;
    EXPECT_GT(view.points().size(), 130U / 4 * (300 / 4)) << ramp;
  }
}

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

/// A fitted body of which some capsules are seen whole, the others not at all.
BodyBelief::Evidence evidence(float cost, int seen, bool moved = false, float height = 1.75F) {
  BodyBelief::Evidence result;
  result.cost.points = cost;
  std::fill_n(result.support.seen.begin(), seen, 1.0F);
  result.height = height;
  result.moved = moved;
  return result;
}

bool believedAfter(BodyBelief& belief, const BodyBelief::Evidence& evidence, int views) {
  for (int i = 0; i < views; ++i) belief.update(evidence);
  return belief.believed();
}

TEST(BodyBelief, OneViewThatFitsWellIsEnough) {
  BodyBelief belief;
  EXPECT_FALSE(belief.believed());
  EXPECT_TRUE(believedAfter(belief, evidence(900.0F, 19), 1));
  belief.forget();
  EXPECT_FALSE(belief.believed());
}

TEST(BodyBelief, FurnitureIsNeverBelieved) {
  // What chairs of the recordings got: a bad fit, or a better one of which half is not seen, or a giant.
  for (const auto& chair : {evidence(1380.0F, 18), evidence(1150.0F, 12), evidence(900.0F, 20, false, 2.2F)}) {
    BodyBelief belief;
    EXPECT_FALSE(believedAfter(belief, chair, 100));
  }
}

TEST(BodyBelief, WhoeverMovedNeedsLess) {
  BodyBelief still, moved;
  EXPECT_FALSE(believedAfter(still, evidence(1500.0F, 12), 30));
  EXPECT_FALSE(believedAfter(moved, evidence(1500.0F, 12, true), 2));
  EXPECT_TRUE(believedAfter(moved, evidence(1500.0F, 12, true), 1));
}

TEST(BodyBelief, LastsThroughAShortBadTimeOnly) {
  BodyBelief belief;
  ASSERT_TRUE(believedAfter(belief, evidence(900.0F, 19), 1));
  EXPECT_TRUE(believedAfter(belief, evidence(4000.0F, 3), 20));
  EXPECT_TRUE(believedAfter(belief, evidence(900.0F, 19), 30));
  EXPECT_TRUE(believedAfter(belief, evidence(4000.0F, 3), 20));
  EXPECT_FALSE(believedAfter(belief, evidence(4000.0F, 3), 10));
}

TEST(BodyBelief, WhatIsAttachedToTheRoomMustMoveAndBeSeen) {
  BodyBelief::Evidence seated = evidence(2100.0F, 16, true);
  BodyBelief free, attached;
  EXPECT_FALSE(believedAfter(free, seated, 30));
  seated.attached = true;
  EXPECT_TRUE(believedAfter(attached, seated, 3));
  seated.moved = false;
  attached.forget();
  EXPECT_FALSE(believedAfter(attached, seated, 30));
}

}  // namespace
}  // namespace lorica::fit
