#pragma once

#include "capture/retarget/retarget_rig.h"

#include <span>

namespace lorica {

/// World turns of thigh and shin that bring an ankle to a place; what hangs from a bone turns along.
struct LegTurns {
  Quat thigh = Quat::Identity();
  Quat shin = Quat::Identity();
  Vec3 ankle = Vec3::Zero();  ///< where it comes to: the place, or as near as the leg's length allows [m]
};

/// Bends a leg of two bones so that its ankle reaches a place. The plane of hip, knee and ankle turns along with the
/// line from hip to ankle, and the twists change the least; a straight knee bends forwards.
/// @param hinge   unit axis about which the knee bends: the thigh turned by a positive angle folds the shin back
/// @param wanted  [m], world, as the others
[[nodiscard]] LegTurns reachWithLeg(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& hinge,
                                    const Vec3& wanted);

/// How far straight down a hip must come so that its ankle reaches a place; 0 when it does, or never will. A leg
/// reaches nearly its length, for a knee that is quite straight snaps; one that is straighter already may stay so [m].
[[nodiscard]] double dropToReach(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& wanted);

/// World rotations, scales left out, and world transforms of a pose. Allocates nothing.
/// @param worldRotation, worldFromJoint  one a joint, written
void evaluatePose(const Skeleton& skeleton, std::span<const JointTransform> pose, std::span<Quat> worldRotation,
                  std::span<Affine3> worldFromJoint);

/// Brings the ankle of a character to a place by bending the leg; the foot keeps its turn in the world. Legs, their
/// places known, may be bent one after the other before the pose is evaluated again.
/// @param worldRotation, worldFromJoint  as evaluatePose wrote them
void bendLeg(const RetargetRig& rig, std::size_t side, const Vec3& ankle, std::span<const Quat> worldRotation,
             std::span<const Affine3> worldFromJoint, std::span<JointTransform> pose);

}  // namespace lorica
