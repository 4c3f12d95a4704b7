#pragma once

#include "capture/skeleton_frame.h"
#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <vector>

namespace lorica {

/// An upper and a lower limb bone with hand or foot, and the tracked joints they correspond to.
struct LimbBones {
  HumanBone upper;       ///< upper arm or thigh
  HumanBone lower;       ///< lower arm or shin
  HumanBone end;         ///< hand or foot
  BodyJoint upperJoint;  ///< shoulder or hip
  BodyJoint lowerJoint;  ///< elbow or knee
  BodyJoint endJoint;    ///< hand or foot
  Vec3 axis;             ///< along the limb in T-pose, facing +Z
  Vec3 hinge;            ///< axis about which elbow or knee bends, in T-pose
};
inline constexpr int kLimbCount = 4;  ///< left arm, right arm, left leg, right leg
inline constexpr int kFirstLeg = 2;   ///< index of the left leg

/// In the order of kLimbCount.
[[nodiscard]] const std::array<LimbBones, kLimbCount>& limbs();

/// The bone that begins at each tracked joint; at the torso there is none.
inline constexpr std::array<std::optional<HumanBone>, kBodyJointCount> kBoneOfJoint = {
    HumanBone::kHead,          HumanBone::kNeck,          HumanBone::kLeftUpperArm,
    HumanBone::kRightUpperArm, HumanBone::kLeftLowerArm,  HumanBone::kRightLowerArm,
    HumanBone::kLeftHand,      HumanBone::kRightHand,     std::nullopt,
    HumanBone::kLeftUpperLeg,  HumanBone::kRightUpperLeg, HumanBone::kLeftLowerLeg,
    HumanBone::kRightLowerLeg, HumanBone::kLeftFoot,      HumanBone::kRightFoot};

/// Rotation whose columns are left, up and forward: exactly along `left`, with `up` as close as possible. Empty if the
/// two are short or nearly parallel.
[[nodiscard]] std::optional<Quat> frameAlongLeft(const Vec3& left, const Vec3& up);
/// As above, but exactly along `up`.
[[nodiscard]] std::optional<Quat> frameAlongUp(const Vec3& left, const Vec3& up);

/// The bone on the other side of the body; the same bone if it is in the middle.
[[nodiscard]] HumanBone otherSide(HumanBone bone);

/// The smallest rotation from one unit vector to another. If they are opposite, it rotates about `spare`, which must be
/// at least nearly perpendicular to `from`.
[[nodiscard]] Quat swingBetween(const Vec3& from, const Vec3& to, const Vec3& spare);

/// Rotates an orientation by the smallest rotation that points its `axis` along a unit direction; `spare` as above.
[[nodiscard]] Quat pointed(const Quat& orientation, const Vec3& axis, const Vec3& direction, const Vec3& spare);

/// Rises from 0 at `from` to 1 at `to`, with zero slope at both and constant beyond.
[[nodiscard]] double smoothStep(double from, double to, double x);

/// Properties of a skeleton that retargeting needs, independent of its rest pose, joint axes and size.
///
/// The reference is the T-pose, facing +Z, that defines the orientations in TrackedJoint. `tposeFromJoint` of a bone is
/// its world rotation when the character is in that pose: the rest pose rotated upright to face +Z, with arms swung
/// horizontal, legs swung straight, and fingers stretched flat like the hand. Feet keep their angle to the ground,
/// whatever the legs do; feet that point down at rest are swung flat. The rest pose may be lying or sitting. An
/// orientation q as defined for TrackedJoint then gives the world rotation q * tposeFromJoint.
struct RetargetRig {
  Skeleton skeleton;                                  ///< of the character
  std::vector<Quat> tposeFromJoint;                   ///< one per joint; identity if it is no bone
  std::vector<double> spineShare;                     ///< one per joint: 0 rotates with the hips, 1 with the chest
  JointIndex hips = kNoJoint;                         ///< joint of HumanBone::kHips
  JointIndex chest = kNoJoint;                        ///< the uppermost of upperChest, chest and spine
  Vec3 neckAxis = Vec3::UnitY();                      ///< neck to head in T-pose
  Affine3 hipsParentFromWorld = Affine3::Identity();  ///< in the rest pose [m]
  Vec3 restHips = Vec3::Zero();                       ///< world [m]
  double legLength = 0.0;                             ///< thigh plus shin, mean of both legs [m]
  std::array<double, 2> restAnkleHeight{};            ///< left, right, above the character's own floor [m]
  std::array<Vec3, 2> ballFromAnkle;                  ///< from the ankle to the sole below the toe joint, in T-pose [m]
  /// Points below a foot [m].
  struct Sole {
    Vec3 heel;  ///< in the foot's joint frame
    Vec3 ball;  ///< the same
    Vec3 tip;   ///< in the toes' joint frame; in the foot's if the skeleton has no toes
  };
  std::array<Sole, 2> sole;  ///< left, right
  /// About +Y: heading of the line from ankle to toe joint in T-pose, relative to straight ahead. Feet are rarely built
  /// straight: this removes the effect of the foot's shape.
  std::array<Quat, 2> toesHeading = {Quat::Identity(), Quat::Identity()};

  /// @return the rig, or an error with the humanoid bones that are missing, out of order or of zero length
  static Result<RetargetRig> create(const Skeleton& skeleton);
};

}  // namespace lorica
