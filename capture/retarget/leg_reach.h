#pragma once

#include "capture/retarget/retarget_rig.h"

#include <span>

namespace lorica {

/// World rotations of thigh and shin that move an ankle to a position; child joints rotate along.
struct LegTurns {
  Quat thigh = Quat::Identity();
  Quat shin = Quat::Identity();
  Vec3 ankle = Vec3::Zero();  ///< reached position: the target, or the nearest point within the leg's length [m]
};

/// Bends a two-bone leg so that its ankle reaches a position. The plane of hip, knee and ankle rotates with the line
/// from hip to ankle, with minimal change of twist; a straight knee bends forwards.
/// @param hinge   unit axis about which the knee bends: rotating the thigh by a positive angle folds the shin back
/// @param wanted  target position [m], in world space like the others
[[nodiscard]] LegTurns reachWithLeg(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& hinge,
                                    const Vec3& wanted);

/// How far a hip must move straight down so that its ankle reaches a position [m]; 0 if it already does or never will.
/// The max reach is slightly below the leg length, because a fully straight knee snaps; a leg that is already
/// straighter may stay so.
[[nodiscard]] double dropToReach(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& wanted);

/// Computes world rotations, without scales, and world transforms of a pose. Allocates nothing.
/// @param worldRotation, worldFromJoint  one per joint, written
void evaluatePose(const Skeleton& skeleton, std::span<const JointTransform> pose, std::span<Quat> worldRotation,
                  std::span<Affine3> worldFromJoint);

}  // namespace lorica
