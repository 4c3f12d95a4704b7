#pragma once

#include "skinning/humanoid/humanoid.h"

#include <array>
#include <string>
#include <vector>

namespace lorica {

using BoneJoints = std::array<JointIndex, kHumanBoneCount>;

/// A skeleton as guessHumanoid() looks at it: who hangs on whom, and where each joint lies in the rest pose.
class JointTree {
 public:
  explicit JointTree(const Skeleton& skeleton);

  [[nodiscard]] int jointCount() const { return static_cast<int>(parent_.size()); }
  [[nodiscard]] JointIndex parent(JointIndex joint) const { return parent_[at(joint)]; }
  [[nodiscard]] const std::vector<JointIndex>& children(JointIndex joint) const { return children_[at(joint)]; }
  [[nodiscard]] const Vec3& position(JointIndex joint) const { return position_[at(joint)]; }  ///< world [m]
  /// Whether a joint lies below another; a joint does not lie below itself.
  [[nodiscard]] bool isBelow(JointIndex joint, JointIndex ancestor) const;
  [[nodiscard]] bool isBelowOrSame(JointIndex joint, JointIndex ancestor) const {
    return joint == ancestor || isBelow(joint, ancestor);
  }
  /// The lowest joint that both hang on, itself included; the other one where one is kNoJoint; kNoJoint for two trees.
  [[nodiscard]] JointIndex commonAncestor(JointIndex a, JointIndex b) const;
  /// The joints below `top` down to `bottom`, from the top; `bottom` is among them, `top` is not.
  [[nodiscard]] std::vector<JointIndex> pathBelow(JointIndex top, JointIndex bottom) const;

 private:
  [[nodiscard]] static std::size_t at(JointIndex joint) { return static_cast<std::size_t>(joint); }

  std::vector<JointIndex> parent_;
  std::vector<std::vector<JointIndex>> children_;
  std::vector<Vec3> position_;
  std::vector<int> entered_;  ///< in a walk from the roots: a joint's subtree is entered_ to left_
  std::vector<int> left_;
};

}  // namespace lorica
