#include "capture/retarget/leg_reach.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// Max reach as a fraction of leg length. There the knee is bent by 5 degrees.
constexpr double kLongestReach = 0.999;
constexpr double kShortest = 1e-6;

double reachOfLeg(double thigh, double shin) {
  return kLongestReach * (thigh + shin);
}

}  // namespace

double dropToReach(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& wanted) {
  const double reach = std::max(reachOfLeg((knee - hip).norm(), (ankle - knee).norm()), (ankle - hip).norm());
  if ((wanted - hip).norm() <= reach) return 0.0;
  const double level = std::hypot(wanted.x() - hip.x(), wanted.z() - hip.z());
  const double height = level < reach ? std::sqrt(reach * reach - level * level) : 0.0;
  return std::max(0.0, hip.y() - wanted.y() - height);
}

void evaluatePose(const Skeleton& skeleton, std::span<const JointTransform> pose, std::span<Quat> worldRotation,
                  std::span<Affine3> worldFromJoint) {
  computeWorldFromJoint(skeleton, pose, worldFromJoint);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const JointIndex parent = skeleton.joint(static_cast<JointIndex>(j)).parent;
    const Quat above = parent == kNoJoint ? Quat::Identity() : worldRotation[parent];
    worldRotation[j] = (above * pose[j].rotation).normalized();
  }
}

LegTurns reachWithLeg(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& hinge, const Vec3& wanted) {
  LegTurns turns;
  turns.ankle = ankle;
  const double thigh = (knee - hip).norm();
  const double shin = (ankle - knee).norm();
  const double before = (ankle - hip).norm();
  const double away = (wanted - hip).norm();
  if (thigh < kShortest || shin < kShortest || before < kShortest || away < kShortest) return turns;
  const Vec3 thighBefore = (knee - hip) / thigh;
  const Vec3 shinBefore = (ankle - knee) / shin;
  const Vec3 lineBefore = (ankle - hip) / before;
  const Vec3 line = (wanted - hip) / away;

  // The current bending axis; if the bend is small or backwards, the hinge axis.
  constexpr double kMinBend = 0.15;  // sine
  const Vec3 bend = thighBefore.cross(shinBefore);
  const Vec3 straight = hinge - hinge.dot(lineBefore) * lineBefore;
  const Vec3 axis = bend + std::max(0.0, kMinBend - bend.dot(straight)) * straight;

  const Quat swing = swingBetween(lineBefore, line, hinge);
  Vec3 turned = swing * axis;
  turned -= turned.dot(line) * line;
  if (turned.norm() < kShortest) return turns;
  // A leg that is already longer than the usual reach may stay so: nothing moves if the target is the current ankle
  // position.
  const double longest = std::max(reachOfLeg(thigh, shin), std::min(before, (1.0 - 1e-9) * (thigh + shin)));
  const double shortest = std::abs(thigh - shin) + 1e-3 * (thigh + shin);
  const double reach = std::clamp(away, std::min(shortest, longest), longest);
  const double cosine = std::clamp((thigh * thigh + reach * reach - shin * shin) / (2.0 * thigh * reach), -1.0, 1.0);
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const Vec3 toKnee = thigh * (cosine * line + sine * line.cross(turned.normalized()));
  turns.ankle = hip + reach * line;
  const Vec3 thighAfter = toKnee / thigh;
  const Vec3 shinAfter = (turns.ankle - hip - toKnee).normalized();
  turns.thigh = (swingBetween(swing * thighBefore, thighAfter, swing * hinge) * swing).normalized();
  turns.shin = (swingBetween(swing * shinBefore, shinAfter, swing * hinge) * swing).normalized();
  return turns;
}

}  // namespace lorica
