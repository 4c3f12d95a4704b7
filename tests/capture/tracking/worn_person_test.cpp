#include "capture/tracking/people_places.h"

#include "capture/synthetic/synthetic_motion.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

SkeletonFrame someone() {
  SkeletonFrame person = synthesizeMotion(SyntheticMotion::kWave).front();
  for (TrackedJoint& joint : person.joints) joint.confidence = 0.7;
  return person;
}

TEST(WornPerson, TheHeadGoesWithTheHeadsetAndTheFeetStay) {
  const SkeletonFrame before = someone();
  SkeletonFrame person = before;
  const WornHead then{before[BodyJoint::kHead].position + Vec3(0.02, 0.01, 0.0), Quat::Identity()};
  const WornHead latest{then.position + Vec3(0.1, -0.05, 0.04), Quat(Eigen::AngleAxisd(0.4, Vec3::UnitY()))};
  moveWithHead(then, latest, person);
  EXPECT_EQ(person[BodyJoint::kHead].position, latest.position);
  EXPECT_EQ(person[BodyJoint::kHead].orientation->coeffs(), latest.orientation.coeffs());
  EXPECT_EQ(person[BodyJoint::kHead].confidence, 1.0);
  for (const BodyJoint joint : {BodyJoint::kLeftFoot, BodyJoint::kLeftHip, BodyJoint::kNeck}) {
    const double share = before[joint].position.y() / then.position.y();
    const Vec3 expected = before[joint].position + share * Vec3(0.1, -0.05, 0.04);
    EXPECT_LT((person[joint].position - expected).norm(), 1e-12);
    EXPECT_EQ(person[joint].confidence, 0.7);
  }
  EXPECT_LT((person[BodyJoint::kLeftFoot].position - before[BodyJoint::kLeftFoot].position).norm(), 0.01);
}

TEST(WornPerson, AnothersHeadsetMovesNobody) {
  const SkeletonFrame before = someone();
  const WornHead beside{before[BodyJoint::kHead].position + Vec3(0.8, 0.0, 0.0), Quat::Identity()};
  SkeletonFrame person = before;
  moveWithHead(beside, {beside.position + Vec3(0.1, 0.0, 0.0), Quat::Identity()}, person);
  EXPECT_EQ(person[BodyJoint::kHead].position, before[BodyJoint::kHead].position);
  // Of a head that is not seen the torso tells.
  person[BodyJoint::kHead].confidence = 0.1;
  moveWithHead(beside, beside, person);
  EXPECT_EQ(person[BodyJoint::kHead].confidence, 0.1);
  const WornHead above{before[BodyJoint::kTorso].position + Vec3(0.3, 0.6, 0.0), Quat::Identity()};
  moveWithHead(above, above, person);
  EXPECT_EQ(person[BodyJoint::kHead].position, above.position);
  // An empty place has no torso either.
  SkeletonFrame nobody;
  moveWithHead(above, above, nobody);
  EXPECT_EQ(nobody[BodyJoint::kHead].confidence, 0.0);
}

}  // namespace
}  // namespace lorica
