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

/// Proportions of a body relative to the original; all are factors.
struct BodyProportions {
  double height = 1.0;  ///< overall
  double girth = 1.0;   ///< limbs and trunk around their bones; joints keep their positions
  double arms = 1.0;    ///< lengths of upper arms and forearms
  double legs = 1.0;    ///< lengths of thighs and shins
  double trunk = 1.0;   ///< length from the hips to the neck

  friend bool operator==(const BodyProportions&, const BodyProportions&) = default;
};

/// Returns a modified body: mesh, bind pose and rest pose change consistently, and the lowest vertex keeps its height
/// above the floor, relative to the body height.
/// @param character    with humanoid bones; missing bones are ignored
/// @param proportions  all above 0
[[nodiscard]] Character withProportions(const Character& character, const BodyProportions& proportions);

/// A character that performs a motion: its surface and the 15 joints of its body at any time.
///
/// The motion is retargeted to the character once; poses are interpolated between its frames. Single-threaded.
class VirtualPerformer {
 public:
  /// @param character  with its humanoid bones; its `shown` triangles are the visible surface
  /// @param recording  joints, at least one frame, times increasing; retargeted by Retargeter
  /// @return the performer, or an error with the missing humanoid bones
  static Result<VirtualPerformer> create(Character character, std::span<const SkeletonFrame> recording);
  /// @param motion  of any humanoid skeleton, retargeted by retargetMotion(), or by retargetByJointNames() if the
  /// joints have the same names as the character's
  static Result<VirtualPerformer> create(Character character, const SkeletalMotion& motion);

  /// Duration of the motion, from its first frame to its last [s].
  [[nodiscard]] double seconds() const { return motion_.times.back() - motion_.times.front(); }
  [[nodiscard]] const Character& character() const { return character_; }

  /// Evaluates the pose at a time; allocates nothing.
  /// @param time            from the first frame [s]; clamped to the first and last pose
  /// @param targetFromWorld transform from the motion's world to the target frame
  void pose(double time, const Isometry3& targetFromWorld);

  /// From the last pose(), target frame [m].
  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }
  [[nodiscard]] std::span<const Triangle> triangles() const {
    return character_.shown.empty() ? character_.mesh.triangles : character_.shown;
  }
  [[nodiscard]] SurfaceSides sides() const { return sides_; }

  /// The true joints of the last pose(), target frame, as defined by bodyJointsOf(): confidence 1, or 0 if the
  /// character lacks the bone. Orientations are relative to the T-pose of a person who faces the target frame's +Z.
  [[nodiscard]] const SkeletonFrame& joints() const { return joints_; }

 private:
  VirtualPerformer(Character character, SkeletalMotion motion);

  Character character_;
  SkeletalMotion motion_;  ///< of the character's skeleton
  SurfaceSides sides_ = SurfaceSides::kBoth;
  std::vector<std::array<std::optional<Quat>, kBodyJointCount>> orientations_;  ///< one per frame; world
  Pose pose_;
  std::vector<Affine3> targetFromJoint_, targetFromModel_;
  std::vector<Vec3> positions_;
  SkeletonFrame joints_;
};

}  // namespace lorica
