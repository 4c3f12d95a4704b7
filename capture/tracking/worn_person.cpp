#include "capture/tracking/worn_person.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// How far a torso may be from below its head, and a seen head from where its headset says that it is [m].
constexpr double kTorsoReach = 0.6, kHeadReach = 0.35;
constexpr double kLowest = 0.3;  ///< of a head: below it the person lies, and moves as a whole [m]

bool wears(const WornHead& worn, const SkeletonFrame& person) {
  const TrackedJoint& head = person[BodyJoint::kHead];
  if (head.confidence >= 0.5) return (head.position - worn.position).norm() < kHeadReach;
  const TrackedJoint& torso = person[BodyJoint::kTorso];
  const Vec3 off = torso.position - worn.position;
  return torso.confidence > 0.0 && std::hypot(off.x(), off.z()) < kTorsoReach;
}

}  // namespace

void moveWithHead(const WornHead& then, const WornHead& latest, SkeletonFrame& person) {
  if (!wears(then, person)) return;
  const Vec3 moved = latest.position - then.position;
  for (TrackedJoint& joint : person.joints) {
    joint.position += std::clamp(joint.position.y() / std::max(then.position.y(), kLowest), 0.0, 1.0) * moved;
  }
  person[BodyJoint::kHead] = {latest.position, latest.orientation, 1.0};
}

}  // namespace lorica
