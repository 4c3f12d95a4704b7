#pragma once

#include "skinning/character.h"
#include "skinning/clip.h"

#include <span>
#include <vector>

namespace lorica {

/// A position as a mirror at x = 0 shows it. So it is also between our axes and Unity's, in which the VMC protocol
/// speaks: Unity is left-handed, with Y up, a body facing +Z and its left at -X.
[[nodiscard]] inline Vec3 mirrored(const Vec3& p) {
  return {-p.x(), p.y(), p.z()};
}
/// A rotation, likewise.
[[nodiscard]] inline Quat mirrored(const Quat& q) {
  return {q.w(), q.x(), -q.y(), -q.z()};
}

/// Negative scales mirror the axes of the joints below them, and with these what a rotation does. Retargeting works on
/// the same body without them: in each joint's frame the axes that the scales above it turned round are turned back.
/// Every point keeps its position. Internal to motion retargeting.
class MirroredAxes {
 public:
  /// @param skeleton  any; most have no negative scale
  explicit MirroredAxes(const Skeleton& skeleton);

  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }  ///< the one that it was made for
  /// Whether there is a negative scale.
  [[nodiscard]] bool any() const { return any_; }
  /// The skeleton without negative scales. If the toes then point backwards by its left and right, these are exchanged:
  /// a body that was mirrored after its joints had been named.
  [[nodiscard]] Skeleton straightened() const;
  /// Converts a pose of the skeleton to one of the straightened one, or back: signs are their own inverse. Allocates
  /// nothing.
  void exchange(std::span<JointTransform> pose) const;
  /// Of a joint's own axes: worldFromJoint * diag(below) is that of the straightened skeleton.
  [[nodiscard]] Vec3 below(JointIndex joint) const { return above_[joint].cwiseProduct(own_[joint]); }

 private:
  Skeleton skeleton_;
  std::vector<Vec3> above_;  ///< one per joint: signs of the product of the scales above it
  std::vector<Vec3> own_;    ///< signs of its own scale
  bool any_ = false;
};

/// The same, of a whole motion and of a character. Without negative scales they are returned as they are.
[[nodiscard]] SkeletalMotion straightened(SkeletalMotion motion);
/// The same character, whose skeleton has no negative scales.
[[nodiscard]] Character straightened(const Character& character);

}  // namespace lorica
