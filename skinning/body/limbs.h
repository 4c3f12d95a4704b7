#pragma once

#include "skinning/character.h"

#include <span>
#include <vector>

namespace lorica {

/// Which bones belong to limbs that only happen to come near each other: two legs, a hand at a thigh.
class Limbs {
 public:
  explicit Limbs(const Character& character);

  /// Whether a place that two bones move belongs to two limbs that touch there, and not to one body that bends: it lies
  /// far down both limbs from where they part, or far down one from the bone that it hangs on.
  /// @param at  in the bind pose [m]
  [[nodiscard]] bool apart(JointIndex a, JointIndex b, const Vec3& at) const;

  /// Whether one of the bones hangs on the other.
  [[nodiscard]] bool onOneBranch(JointIndex a, JointIndex b) const;

 private:
  [[nodiscard]] const Vec3& positionOf(JointIndex joint) const { return at_[static_cast<std::size_t>(joint)]; }
  [[nodiscard]] std::size_t pair(JointIndex a, JointIndex b) const {
    return static_cast<std::size_t>(a) * at_.size() + static_cast<std::size_t>(b);
  }
  /// How far down its bone from a joint a place is [m].
  [[nodiscard]] double along(JointIndex joint, const Vec3& at) const;

  std::vector<Vec3> at_;         ///< joints in the bind pose, model space
  std::vector<Vec3> direction_;  ///< of each joint's bone: towards the joints that hang on it
  std::vector<float> way_;       ///< along the skeleton, jointCount x jointCount [m]
  /// Of two joints of which one hangs on the other, the first on the way down; of others the one that both hang on, or
  /// kNoJoint.
  std::vector<JointIndex> meeting_;
  std::vector<std::uint8_t> onOneBranch_;
  double size_ = 0.0;
};

/// The joint with the largest weight; the first of several.
[[nodiscard]] JointIndex strongest(std::span<const Influence> influences);

}  // namespace lorica
