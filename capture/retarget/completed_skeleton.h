#pragma once

#include "geometry/result.h"
#include "skinning/clip.h"

#include <array>
#include <vector>

namespace lorica {

/// A motion's skeleton with all bones that retargeting needs. Bones that it lacks are added where an adult of its size
/// has them, and marked, since they say nothing of how a body moves.
///
/// A limb needs its upper and lower bone; without both it is added as a whole, hanging as in T-pose. A hand or foot
/// alone is added at the only joint below its limb, else straight ahead of it. A spine is added between the hips and
/// what they carry upwards; hips below the trunk, and they go where it goes, on the level.
///
/// Of a skeleton that lacks nothing it is that skeleton. Internal to the retargeting of motions.
class CompletedSkeleton {
 public:
  /// @return the skeleton; or which bones are missing, where there is no trunk, or no limb with its upper and lower
  /// bone
  static Result<CompletedSkeleton> create(const Skeleton& skeleton);

  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
  /// Whether the motion says how the bone turns, as far as it is one of those that retargeting needs.
  [[nodiscard]] bool speaksOf(HumanBone bone) const { return !silent_[static_cast<std::size_t>(bone)]; }
  /// Whether the motion says where the bone begins, be it by what hangs on it.
  [[nodiscard]] bool knowsPlaceOf(HumanBone bone) const { return !placeless_[static_cast<std::size_t>(bone)]; }
  [[nodiscard]] bool isWhole() const { return indexOf_.empty(); }

  /// The motion of the first skeleton on this one; added bones stay at rest.
  [[nodiscard]] SkeletalMotion complete(const SkeletalMotion& motion) const;

 private:
  CompletedSkeleton() = default;

  Skeleton skeleton_;
  std::vector<JointIndex> indexOf_;  ///< one a joint of the first skeleton; empty where nothing is added
  std::array<bool, kHumanBoneCount> silent_{};
  std::array<bool, kHumanBoneCount> placeless_{};
  JointIndex addedHips_ = kNoJoint;
  JointIndex trunk_ = kNoJoint;  ///< of the first skeleton: what added hips go along with
};

}  // namespace lorica
