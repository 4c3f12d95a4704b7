#pragma once

#include "geometry/random_numbers.h"
#include "skinning/skeleton.h"

#include <span>

namespace lorica {

/// How far a joint turns one way and the other from the T-pose [rad]; least <= 0 <= most.
struct AngleRange {
  double least = 0.0;
  double most = 0.0;
};

/// The range of motion of a joint in a healthy adult, by where it takes its bone.
///
/// The turn is a twist about the bone's length and a swing that tips it: rotation = swing * twist. The swing is a
/// rotation vector, first * firstAxis + second * secondAxis, inside an ellipse whose half axes are the ends of the two
/// ranges, those of each quarter its own: nobody raises an arm as high as it goes and pulls it back as far as it goes
/// at the same time. A hinge has a second range of 0.
///
/// Axes are unit vectors at right angles in model space: of a character in T-pose that faces +Z, its left at +X, palms
/// down. Angles are as large for the right as for the left, axes mirrored in x = 0.
struct JointRange {
  Vec3 twistAxis = Vec3::UnitY();
  Vec3 firstAxis = Vec3::UnitX();
  Vec3 secondAxis = Vec3::UnitZ();
  AngleRange twist, first, second;
  bool twistAtParent = false;  ///< rotation = twist * swing: of the hand, which turns with the forearm's end
};

/// Angles of one joint, each about the axis of that name in its JointRange [rad].
struct JointAngles {
  double twist = 0.0;
  double first = 0.0;
  double second = 0.0;
};

/// Normal ranges of motion of the American Academy of Orthopaedic Surgeons (Joint Motion, 1965), as Norkin and White
/// list them (Measurement of Joint Motion, appendix); those of the collarbone after Levangie and Norkin (Joint
/// Structure and Function, chapter 7).
///
/// Where a body has several joints for one published figure, they share it: the spine's three bones a third each, neck
/// and head a half, forearm and hand half of what the forearm turns, collarbone and upper arm what the arm does in all.
/// The hips turn freely about the vertical and do not tilt.
[[nodiscard]] const JointRange& jointRange(HumanBone bone);

/// The turn with these angles. Made of sums, products and roots only, so that it has the same bits on every machine.
[[nodiscard]] Quat rotationOf(const JointRange& range, const JointAngles& angles);

/// The angles of a turn, unique where it swings by less than half a turn.
[[nodiscard]] JointAngles anglesOf(const JointRange& range, const Quat& rotation);

/// A pose at random: each human bone uniform over its range (of twist and of swing), independent of the others. Other
/// joints, translations and scales stay at rest. It is possible for each joint, and may still put a hand through the
/// chest: joint limits know no flesh.
///
/// Assumes that the skeleton's rest pose is the T-pose and that each human bone's rest axes are those of the model, as
/// VRM 1.0 has them: rest rotations of all joints above them are the identity.
[[nodiscard]] Pose randomPoseWithinLimits(const Skeleton& skeleton, RandomNumbers& random);

/// Whether every human bone of a pose lies within its range. Same assumptions.
/// @param tolerance  of angles [rad]
[[nodiscard]] bool withinLimits(const Skeleton& skeleton, std::span<const JointTransform> pose,
                                double tolerance = 1e-6);

}  // namespace lorica
