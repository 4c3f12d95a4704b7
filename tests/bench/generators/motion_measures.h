#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <string>
#include <vector>

/// Measures of a recorded person, taken from positions and orientations alone.
namespace lorica::measures {

inline constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// A thick limb: approximate volume of a body part.
struct Capsule {
  std::string name;
  Vec3 from, to;
  double radius;
};

/// Distance between two segments [m].
[[nodiscard]] double segmentDistance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

/// Trunk, head, arms, legs and feet.
[[nodiscard]] std::vector<Capsule> bodyOf(const SkeletonFrame& frame);
/// Whether two capsules of bodyOf are neighbours that touch at a joint.
[[nodiscard]] bool adjacent(const std::string& a, const std::string& b);

/// Heel, ball and toe tip on the sole of a bare foot whose ankle is 0.085 m high.
[[nodiscard]] std::array<Vec3, 3> soleOf(const SkeletonFrame& frame, BodyJoint foot);

/// Centre of mass: Winter's segment masses, centres along the segments.
[[nodiscard]] Vec3 massCentre(const SkeletonFrame& frame);

/// The pelvis frame from hips and torso: X to the left hip, Y up the trunk.
[[nodiscard]] Mat3 pelvisAxes(const SkeletonFrame& frame);

[[nodiscard]] double angleBetween(const Vec3& a, const Vec3& b);

}  // namespace lorica::measures
