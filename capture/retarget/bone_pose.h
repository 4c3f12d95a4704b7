#pragma once

#include "capture/retarget/mirrored_axes.h"
#include "capture/retarget/root_and_feet.h"
#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A body's pose by local rotations that are identity in T-pose, facing +Z, whatever the joints' own axes are. VRM
/// calls such a skeleton normalised; the VMC protocol sends it.
struct BonePose {
  Vec3 rootPosition = Vec3::Zero();      ///< of the body's place on the floor [m]
  Quat rootRotation = Quat::Identity();  ///< of that place; the rotation of the hips is relative to it
  /// Relative to the parent bone (parentBone()); a bone that is missing is as in T-pose.
  std::array<std::optional<Quat>, kHumanBoneCount> rotation;
  /// From the parent bone, or from the root for the hips, in the parent's axes [m].
  std::array<Vec3, kHumanBoneCount> offset = filledWithZero();

 private:
  static std::array<Vec3, kHumanBoneCount> filledWithZero() {
    std::array<Vec3, kHumanBoneCount> zeros;
    zeros.fill(Vec3::Zero());
    return zeros;
  }
};

/// Where the bones of a pose are in the world.
struct WorldBones {
  std::array<Quat, kHumanBoneCount> turn;      ///< from the T-pose
  std::array<Vec3, kHumanBoneCount> position;  ///< of the joint where the bone begins [m]
};
/// Bones that the pose lacks follow their parents.
[[nodiscard]] WorldBones worldOf(const BonePose& pose);

/// The pose of the other side: as a mirror shows it.
[[nodiscard]] BonePose mirrored(const BonePose& pose);

/// The pose in which a skeleton has no rotation as a BonePose: its rest pose if that is a T-pose within 25 degrees, as
/// VRM demands, else the T-pose of RetargetRig.
/// @return worldFromJoint rotations, one per joint; identity for joints that are no bones
[[nodiscard]] std::vector<Quat> boneReference(const RetargetRig& rig);

/// Reads the BonePose of a character's poses. Allocates nothing after construction.
class BonePoseReader {
 public:
  /// @return the reader, or an error with the humanoid bones that the skeleton lacks
  static Result<BonePoseReader> create(const Skeleton& skeleton);

  /// @param pose  jointCount local transforms
  /// @return the pose; its root is at the origin, and its hips have their place in the world
  [[nodiscard]] BonePose read(std::span<const JointTransform> pose);

 private:
  BonePoseReader(RetargetRig rig, MirroredAxes mirrored);

  PosedBody body_;
  MirroredAxes mirrored_;
  Pose straight_;  ///< the last pose, if axes are mirrored
  std::vector<Quat> referenceFromJoint_;
  std::array<std::optional<HumanBone>, kHumanBoneCount> parent_;  ///< the nearest one that the skeleton has
};

/// Turns the local transforms of a VRM 1.0 model's own bones, which are not identity in T-pose, to a BonePose.
///
/// The VMC protocol recommends to send those, and the packets do not tell what they are at rest. Bones whose position
/// is missing (zero) get the model's own.
class SenderRest {
 public:
  /// @param skeleton  of the sender's model
  /// @return the conversion, or an error with the humanoid bones that the skeleton lacks
  [[nodiscard]] static Result<SenderRest> create(const Skeleton& skeleton);

  /// @param pose  rotations and offsets as sent, in our axes; output: as BonePose says
  void apply(BonePose& pose) const;

 private:
  SenderRest() = default;

  struct Bone {
    Quat referenceFromParent = Quat::Identity();  ///< of the joint above, at rest, to the T-pose of the bone above
    Vec3 parentInReference = Vec3::Zero();        ///< where that joint is, from the bone above [m]
    Quat jointFromReference = Quat::Identity();   ///< undoes the bone's own axes
    Vec3 rest = Vec3::Zero();                     ///< its translation at rest [m]
  };
  std::array<std::optional<Bone>, kHumanBoneCount> bones_;
};

}  // namespace lorica
