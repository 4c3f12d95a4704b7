#include "capture/tracking/fit/body_model.h"

#include "capture/retarget/skeletal_retarget.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

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

}  // namespace
}  // namespace lorica::fit
