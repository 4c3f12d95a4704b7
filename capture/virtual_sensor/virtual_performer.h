#pragma once

#include "capture/skeleton_frame.h"
#include "capture/virtual_sensor/depth_render.h"
#include "geometry/result.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A character that performs a motion: its surface and the 15 joints of its body at any time.
///
/// The motion is carried to the character once; between its frames poses are interpolated. One thread.
class VirtualPerformer {
 public:
  /// @param character  with its humanoid bones; its `shown` triangles are what is seen
  /// @param recording  joints, at least one frame, times rising; carried by Retargeter
  /// @return the performer, or which humanoid bones are missing
  static Result<VirtualPerformer> create(Character character, std::span<const SkeletonFrame> recording);
  /// @param motion  of any humanoid skeleton, carried by retargetMotion(), or by renameMotion() where the joints bear
  ///                the same names as the character's
  static Result<VirtualPerformer> create(Character character, const SkeletalMotion& motion);

  /// Of the motion, from its first frame to its last [s].
  [[nodiscard]] double seconds() const { return motion_.times.back() - motion_.times.front(); }
  [[nodiscard]] const Character& character() const { return character_; }

  /// Takes the pose of a time; allocates nothing.
  /// @param time            from the first frame [s]; before and after the motion its first and last pose
  /// @param targetFromWorld where the motion's world lies in the frame that is asked for
  void pose(double time, const Isometry3& targetFromWorld);

  /// Of pose(), target frame [m].
  [[nodiscard]] std::span<const Vec3> places() const { return places_; }
  [[nodiscard]] std::span<const Triangle> triangles() const {
    return character_.shown.empty() ? character_.mesh.triangles : character_.shown;
  }
  [[nodiscard]] SurfaceSides sides() const { return sides_; }

  /// The true joints of pose(), target frame, as bodyJointsOf() defines them: confidence 1, or 0 where the character
  /// lacks the bone. Orientations turn from the T-pose of someone who faces the target frame's +Z.
  [[nodiscard]] const SkeletonFrame& joints() const { return joints_; }

 private:
  VirtualPerformer(Character character, SkeletalMotion motion);

  Character character_;
  SkeletalMotion motion_;  ///< of the character's skeleton
  SurfaceSides sides_ = SurfaceSides::kBoth;
  std::vector<std::array<std::optional<Quat>, kBodyJointCount>> orientations_;  ///< one a frame; world
  Pose pose_;
  std::vector<Affine3> targetFromJoint_, targetFromModel_;
  std::vector<Vec3> places_;
  SkeletonFrame joints_;
};

}  // namespace lorica
