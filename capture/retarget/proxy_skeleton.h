#pragma once

#include "capture/retarget/retarget_rig.h"
#include "geometry/result.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <array>
#include <span>
#include <vector>

namespace lorica {

/// A skeleton that can be retargeted, in the place of one that cannot: of a game character whose feet hang on the root
/// as targets, or whose limbs are one joint each.
///
/// A hand or foot that hangs elsewhere hangs on the limb here, with all that is below it: a joint that is the bone, or
/// bears its name and lies near the limb's end, or hangs outside the hips and lies at the limb's end. Where there is no
/// such joint, one that moves nothing is added where the limb's mesh ends. A limb without a lower bone gets a joint
/// halfway to its end; carried back, the limb is straight and points at where its end is in the stand-in, and the hips
/// are lifted where that takes the sole under the floor, y = 0.
///
/// Of a skeleton that can be retargeted as it is, the stand-in is that skeleton.
/// It remembers no frame, but has room for one: one instance a thread.
class StandInSkeleton {
 public:
  /// A bone of the stand-in that the character lacks, or has elsewhere.
  struct Substitute {
    HumanBone bone;
    JointIndex joint = kNoJoint;  ///< of the character: hung on the limb; kNoJoint where one is added
    JointIndex on = kNoJoint;     ///< of the character: the limb's last joint of its own
  };

  /// @param character  with its humanoid bones, checkCharacter() passed
  /// @return the stand-in; or which bones are missing, where hips, spine or an upper limb is, or a limb without an end
  ///         has no mesh
  static Result<StandInSkeleton> create(const Character& character);

  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
  /// Empty where the stand-in is the character's own skeleton.
  [[nodiscard]] std::span<const Substitute> substitutes() const { return substitutes_; }

  /// The stand-in's joint that a joint of the character goes with.
  [[nodiscard]] JointIndex standInOf(JointIndex own) const {
    return standInOf_.empty() ? own : standInOf_[static_cast<std::size_t>(own)];
  }

  /// Writes the character's pose that looks as a stand-in's. Scales are those of the rest pose where a joint hangs
  /// elsewhere. Allocates nothing.
  /// @param standInPose  skeleton().jointCount() local transforms
  /// @param pose         the character's jointCount local transforms, written
  void carryBack(std::span<const JointTransform> standInPose, std::span<JointTransform> pose);
  /// The same of a motion of skeleton(), frame for frame.
  [[nodiscard]] SkeletalMotion carryBack(SkeletalMotion motion);

 private:
  /// A limb whose lower joint the character lacks.
  struct StiffLimb {
    JointIndex upper, lower, end;  ///< of the stand-in
    Vec3 along;                    ///< unit, from upper to end at rest, in the upper joint's rotation
  };
  struct SolePoint {
    JointIndex joint;  ///< of the stand-in
    Vec3 place;        ///< in the joint
  };

  StandInSkeleton() = default;
  void stiffen(std::span<const JointTransform> standInPose);

  Skeleton own_;
  Skeleton skeleton_;
  std::vector<Substitute> substitutes_;
  std::vector<JointIndex> standInOf_;  ///< one a joint of the character
  std::vector<bool> sameParent_;       ///< one a joint of the character: its local transform is the stand-in's
  std::vector<StiffLimb> stiff_;
  std::vector<SolePoint> soles_;  ///< of legs without feet or shins of their own
  Affine3 hipsParentFromWorld_ = Affine3::Identity();

  Pose shown_;  ///< of the stand-in, stiff limbs straight
  std::vector<Quat> standInRotation_, ownRotation_;
  std::vector<Affine3> worldFromStandIn_, worldFromOwn_;
};

/// Whether a character can perform any humanoid's motion, by a stand-in if need be.
[[nodiscard]] bool canPerform(const Character& character);

}  // namespace lorica
