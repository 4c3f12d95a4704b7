#pragma once

#include "skinning/character.h"

#include <span>
#include <vector>

namespace lorica {

/// Distinguishes bones of limbs that only happen to be close together: two legs, a hand at a thigh.
class Limbs {
 public:
  explicit Limbs(const Character& character);

  /// Whether a position moved by two bones belongs to two limbs that touch there, and not to one body that bends: it is
  /// far down both limbs from where they branch, or far down one from the bone that carries it.
  /// @param at  in the bind pose [m]
  [[nodiscard]] bool apart(JointIndex a, JointIndex b, const Vec3& at) const;

  /// Whether one of the bones is an ancestor of the other, or both are the same.
  [[nodiscard]] bool onOneBranch(JointIndex a, JointIndex b) const;

 private:
  [[nodiscard]] const Vec3& positionOf(JointIndex joint) const { return at_[joint]; }
  [[nodiscard]] std::size_t pair(JointIndex a, JointIndex b) const { return a * at_.size() + b; }
  /// Distance of a position from a joint along the joint's bone, at least 0 [m].
  [[nodiscard]] double along(JointIndex joint, const Vec3& at) const;

  std::vector<Vec3> at_;         ///< joints in the bind pose, model space
  std::vector<Vec3> direction_;  ///< of each joint's bone: towards its child joints
  /// For a pair of joints, how far the second is from where they meet, along the skeleton; jointCount x jointCount [m].
  /// They meet at their lowest common ancestor, or if one is an ancestor of the other at the first joint on the path
  /// down; -1 if they do not.
  std::vector<float> down_;
  std::vector<std::uint8_t> onOneBranch_;
  double size_ = 0.0;
};

/// The joint with the largest weight; on ties the first.
[[nodiscard]] JointIndex strongest(std::span<const Influence> influences);

}  // namespace lorica
