#pragma once

#include "geometry/result.h"
#include "skinning/clip.h"

#include <array>
#include <vector>

namespace lorica {

/// A motion's skeleton with all bones that retargeting needs. Missing bones are added at the positions they have in an
/// adult of this size, and marked, because they carry no information about the motion.
///
/// A limb needs its upper and lower bone; without both, the whole limb is added as in T-pose. A missing hand or foot is
/// added at the only joint below its limb, else straight ahead of the limb. A missing spine is added between the hips
/// and the body above them; missing hips are added below the trunk and follow its horizontal motion.
///
/// If nothing is missing, this is the original skeleton. Internal to motion retargeting.
class CompletedSkeleton {
 public:
  /// @return the skeleton; or an error with the missing bones if there is no trunk or no limb with an upper and lower
  /// bone
  static Result<CompletedSkeleton> create(const Skeleton& skeleton);

  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
  /// Whether the motion defines the bone's rotation, for bones that retargeting needs.
  [[nodiscard]] bool speaksOf(HumanBone bone) const { return !silent_[static_cast<std::size_t>(bone)]; }
  /// Whether the motion defines the start position of the bone, possibly through its children.
  [[nodiscard]] bool knowsPositionOf(HumanBone bone) const { return !placeless_[static_cast<std::size_t>(bone)]; }
  [[nodiscard]] bool isWhole() const { return indexOf_.empty(); }

  /// The motion on the completed skeleton; added bones stay at rest.
  [[nodiscard]] SkeletalMotion complete(const SkeletalMotion& motion) const;

 private:
  CompletedSkeleton() = default;

  Skeleton skeleton_;
  std::vector<JointIndex> indexOf_;  ///< one per joint of the original skeleton; empty if nothing was added
  std::array<bool, kHumanBoneCount> silent_{};
  std::array<bool, kHumanBoneCount> placeless_{};
  JointIndex addedHips_ = kNoJoint;
  JointIndex trunk_ = kNoJoint;  ///< joint of the original skeleton that added hips follow
};

/// Whether a motion has frames, each with one transform per joint; else an error with the counts.
[[nodiscard]] Result<void> checkFrames(const SkeletalMotion& motion);

}  // namespace lorica
