#pragma once

#include "geometry/random_numbers.h"
#include "skinning/skeleton.h"

#include <span>

namespace lorica {

/// How far a joint rotates in each direction from the T-pose [rad]; min <= 0 <= max.
struct AngleRange {
  double min = 0.0;
  double max = 0.0;
};

/// The range of motion of a joint in a healthy adult.
///
/// A rotation consists of a twist about the bone's length and a swing that tilts the bone: rotation = swing * twist.
/// The swing is a rotation vector, first * firstAxis + second * secondAxis, inside an ellipse whose half axes are the
/// ends of the two ranges, separately for each quadrant: an arm cannot be fully raised and fully pulled back at the
/// same time. A hinge has a second range of 0.
///
/// Axes are orthogonal unit vectors in model space: character in T-pose, facing +Z, its left at +X, palms down. The
/// right side has the angles of the left side and its axes mirrored in x = 0.
struct JointRange {
  Vec3 twistAxis = Vec3::UnitY();
  Vec3 firstAxis = Vec3::UnitX();
  Vec3 secondAxis = Vec3::UnitZ();
  AngleRange twist, first, second;
  bool twistAtParent = false;  ///< rotation = twist * swing: for the hand, which twists with the forearm's end
};

/// Angles of one joint, each about the axis of the same name in its JointRange [rad].
struct JointAngles {
  double twist = 0.0;
  double first = 0.0;
  double second = 0.0;
};

/// Normal ranges of motion of the American Academy of Orthopaedic Surgeons (Joint Motion, 1965), as listed by Norkin
/// and White (Measurement of Joint Motion, appendix); those of the collarbone from Levangie and Norkin (Joint Structure
/// and Function, chapter 7).
///
/// Several joints that correspond to one published figure share it: a third for each of the spine's three bones, half
/// each for neck and head, half of the forearm's rotation each for forearm and hand; collarbone and upper arm add up to
/// the range of the whole arm. The hips rotate freely about the vertical and do not tilt.
[[nodiscard]] const JointRange& jointRange(HumanBone bone);

/// The rotation with these angles. Uses only sums, products and roots, so that it is bit-identical on every machine.
[[nodiscard]] Quat rotationOf(const JointRange& range, const JointAngles& angles);

/// The angles of a rotation, unique if it swings by less than half a turn.
[[nodiscard]] JointAngles anglesOf(const JointRange& range, const Quat& rotation);

/// A random pose: each human bone uniform over its range (of twist and of swing), independent of the others. Other
/// joints, translations and scales stay at rest. Joint limits do not prevent collisions: a hand may be inside the
/// chest.
///
/// Assumes that the skeleton's rest pose is the T-pose and that each human bone's rest axes are those of the model, as
/// in VRM 1.0: the rest rotations of all joints above it are the identity.
[[nodiscard]] Pose randomPoseWithinLimits(const Skeleton& skeleton, RandomNumbers& random);

/// Whether every human bone of a pose is within its range. Assumes the same as randomPoseWithinLimits().
/// @param tolerance  of angles [rad]
[[nodiscard]] bool withinLimits(const Skeleton& skeleton, std::span<const JointTransform> pose,
                                double tolerance = 1e-6);

}  // namespace lorica
