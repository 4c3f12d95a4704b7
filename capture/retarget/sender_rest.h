#pragma once

#include "capture/retarget/bone_pose.h"

#include <array>
#include <optional>

namespace lorica {

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
