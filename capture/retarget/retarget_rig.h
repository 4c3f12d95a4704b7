#pragma once

#include "capture/skeleton_frame.h"
#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// An upper and a lower limb bone with what hangs from them, and where the joints are tracked.
struct LimbBones {
  HumanBone upper;
  HumanBone lower;
  HumanBone end;  ///< hand or foot
  BodyJoint upperJoint;
  BodyJoint lowerJoint;
  BodyJoint endJoint;
  Vec3 axis;   ///< along the limb in T-pose, facing +Z
  Vec3 hinge;  ///< about which elbow or knee bends, in T-pose
};
inline constexpr int kLimbCount = 4;  ///< left arm, right arm, left leg, right leg
inline constexpr int kFirstLeg = 2;

[[nodiscard]] const std::array<LimbBones, kLimbCount>& limbs();

/// Rotation whose columns are left, up and forward: exactly along `left`, `up` as near as that allows.
/// Nothing when the two are short or nearly parallel.
[[nodiscard]] std::optional<Quat> frameAlongLeft(const Vec3& left, const Vec3& up);
/// The same, exactly along `up`.
[[nodiscard]] std::optional<Quat> frameAlongUp(const Vec3& left, const Vec3& up);

/// The bone on the other side of the body; the same in the middle.
[[nodiscard]] HumanBone otherSide(HumanBone bone);

/// The smallest rotation from one unit vector to another; about `spare`, which is perpendicular to `from` or nearly,
/// when they are opposite.
[[nodiscard]] Quat swingBetween(const Vec3& from, const Vec3& to, const Vec3& spare);

/// An orientation, turned the smallest way so that its `axis` points along a unit direction; `spare` as above.
[[nodiscard]] Quat pointed(const Quat& orientation, const Vec3& axis, const Vec3& direction, const Vec3& spare);

/// From 0 at `from` to 1 at `to`, level at both and beyond.
[[nodiscard]] double smoothStep(double from, double to, double x);

/// What retargeting needs to know of a skeleton, whatever its rest pose, joint axes and size.
///
/// The pivot is the T-pose, facing +Z, of the orientations in TrackedJoint. `tposeFromJoint` of a bone is its world
/// rotation when the character stands so: the rest pose turned upright to face +Z, its arms swung level, its legs swung
/// straight, its fingers stretched as flat as the hand. Feet stay on the ground as flat as they were, whatever the legs
/// do; those that point down at rest are swung flat. A rest pose may lie or sit. Then an orientation q in
/// TrackedJoint's sense makes the world rotation q * tposeFromJoint.
struct RetargetRig {
  Skeleton skeleton;
  std::vector<Quat> tposeFromJoint;  ///< one a joint; identity where no bone is
  std::vector<double> spineShare;    ///< one a joint: 0 turns with the hips, 1 with the chest
  JointIndex hips = kNoJoint;
  JointIndex chest = kNoJoint;    ///< the uppermost of upperChest, chest and spine
  Vec3 neckAxis = Vec3::UnitY();  ///< neck to head in T-pose
  Affine3 hipsParentFromWorld = Affine3::Identity();
  Vec3 restHips = Vec3::Zero();             ///< world [m]
  double legLength = 0.0;                   ///< thigh and shin, mean of both legs [m]
  std::array<double, 2> restAnkleHeight{};  ///< left, right, above the character's own floor [m]
  std::array<Vec3, 2> ballFromAnkle;        ///< from the ankle to the sole under the toes' joint, in T-pose [m]
  struct Sole {
    Vec3 heel, ball;  ///< in the foot's joint
    Vec3 tip;         ///< in the toes' joint; in the foot's where the skeleton has no toes
  };
  std::array<Sole, 2> sole;
  /// About +Y: where the toes' joint lies from the ankle in T-pose, against straight ahead. Feet are seldom built
  /// straight: this takes out what is only the shape of the foot.
  std::array<Quat, 2> toesHeading = {Quat::Identity(), Quat::Identity()};

  /// @return the rig, or which humanoid bones are missing, out of order or of no length
  static Result<RetargetRig> create(const Skeleton& skeleton);
};

/// The bones that every skeleton must have to be retargeted; besides these one of spine, chest and upperChest.
[[nodiscard]] std::span<const HumanBone> bonesNeededToRetarget();

}  // namespace lorica
