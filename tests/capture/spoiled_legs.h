#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <span>

namespace lorica::test {

struct LegJoints {
  BodyJoint hip, knee, foot;
};
inline constexpr std::array<LegJoints, 2> kLegs = {
    LegJoints{BodyJoint::kLeftHip, BodyJoint::kLeftKnee, BodyJoint::kLeftFoot},
    LegJoints{BodyJoint::kRightHip, BodyJoint::kRightKnee, BodyJoint::kRightFoot}};

/// Turns legs upside down about their hips.
inline void turnUpwards(SkeletonFrame& frame, std::span<const LegJoints> legs = kLegs) {
  for (const LegJoints& leg : legs) {
    const double height = frame[leg.hip].position.y();
    for (const BodyJoint joint : {leg.knee, leg.foot}) {
      frame[joint].position.y() = 2.0 * height - frame[joint].position.y();
    }
  }
}

/// Multiplies the lengths of both thighs.
inline void scaleThighs(SkeletonFrame& frame, double factor) {
  for (const LegJoints& leg : kLegs) {
    const Vec3 thigh = frame[leg.knee].position - frame[leg.hip].position;
    frame[leg.knee].position = frame[leg.hip].position + factor * thigh;
  }
}

}  // namespace lorica::test
