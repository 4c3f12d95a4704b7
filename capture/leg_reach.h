#pragma once

#include "geometry/math.h"

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

/// How far a leg reaches: nearly its length, for a knee that is quite straight snaps [m].
[[nodiscard]] double reachOfLeg(double thigh, double shin);

}  // namespace lorica
