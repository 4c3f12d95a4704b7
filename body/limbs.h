#pragma once

#include "skinning/character.h"

#include <span>
#include <vector>

namespace lorica {

/// Which bones belong to limbs that only happen to come near each other: two legs, a hand at a thigh.
class Limbs {
 public:
  explicit Limbs(const Character& character);

  /// Whether a place that two bones move belongs to two limbs that touch there, and not to one body that bends: the way
  /// along the skeleton from one to the other is long for what is so near.
  /// @param at  in the bind pose [m]
  [[nodiscard]] bool apart(JointIndex a, JointIndex b, const Vec3& at) const;

  /// Whether one of the bones hangs on the other.
  [[nodiscard]] bool onOneBranch(JointIndex a, JointIndex b) const;

  [[nodiscard]] const Vec3& positionOf(JointIndex joint) const { return at_[static_cast<std::size_t>(joint)]; }

 private:
  [[nodiscard]] std::size_t pair(JointIndex a, JointIndex b) const {
    return static_cast<std::size_t>(a) * at_.size() + static_cast<std::size_t>(b);
  }
  std::vector<Vec3> at_;    ///< joints in the bind pose, model space
  std::vector<float> way_;  ///< along the skeleton, jointCount x jointCount [m]
  std::vector<std::uint8_t> onOneBranch_;
  double size_ = 0.0;
};

/// The joint with the largest weight; the first of several.
[[nodiscard]] JointIndex strongest(std::span<const Influence> influences);

}  // namespace lorica
