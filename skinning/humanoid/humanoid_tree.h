#pragma once

#include "geometry/counts.h"
#include "skinning/humanoid/humanoid.h"

#include <array>
#include <span>
#include <vector>

namespace lorica {

using BoneJoints = std::array<JointIndex, kHumanBoneCount>;

/// A skeleton as guessHumanoid() uses it: the hierarchy, and the position of each joint in the rest pose.
class JointTree {
 public:
  explicit JointTree(const Skeleton& skeleton);

  [[nodiscard]] int jointCount() const { return countOf(parent_); }
  [[nodiscard]] JointIndex parent(JointIndex joint) const { return parent_[at(joint)]; }
  [[nodiscard]] const std::vector<JointIndex>& children(JointIndex joint) const { return children_[at(joint)]; }
  [[nodiscard]] const Vec3& position(JointIndex joint) const { return position_[at(joint)]; }  ///< world [m]
  [[nodiscard]] double distance(JointIndex a, JointIndex b) const {
    return (position(a) - position(b)).norm();
  }  ///< [m]
  /// Whether a joint is a descendant of another; a joint is not below itself.
  [[nodiscard]] bool isBelow(JointIndex joint, JointIndex ancestor) const;
  [[nodiscard]] bool isBelowOrSame(JointIndex joint, JointIndex ancestor) const {
    return joint == ancestor || isBelow(joint, ancestor);
  }
  /// The lowest common ancestor, which may be a or b; the other one if one is kNoJoint; kNoJoint for separate trees.
  [[nodiscard]] JointIndex commonAncestor(JointIndex a, JointIndex b) const;
  /// The joints from below `top` to `bottom`, in this order; includes `bottom`, excludes `top`.
  [[nodiscard]] std::vector<JointIndex> pathBelow(JointIndex top, JointIndex bottom) const;

 private:
  [[nodiscard]] static std::size_t at(JointIndex joint) { return joint; }

  std::vector<JointIndex> parent_;
  std::vector<std::vector<JointIndex>> children_;
  std::vector<Vec3> position_;
  std::vector<int> entered_;  ///< depth-first numbers: a joint's subtree is [entered_, left_)
  std::vector<int> left_;
};

/// For each joint, the length of the longest path down from it [m], and the child on that path (kNoJoint at a leaf).
struct Reach {
  std::vector<double> length;
  std::vector<JointIndex> next;
  std::vector<int> size;  ///< number of joints of its subtree, including itself

  explicit Reach(const JointTree& tree);
  /// The longest path from a joint to a leaf, its first 16 joints at most.
  [[nodiscard]] std::vector<JointIndex> wayDown(JointIndex joint) const;
};

/// The joints of a limb: shoulder or hip, elbow or knee, wrist or ankle; kNoJoint if the limb is too short.
struct Limb {
  JointIndex upper = kNoJoint;
  JointIndex lower = kNoJoint;
  JointIndex end = kNoJoint;
  JointIndex beyond = kNoJoint;  ///< the next joint after the end: a leg's toes
};

enum class LimbKind { kLeg, kArm };

/// Chooses three joints of a path down a limb, which may have more: those that split it into two similar lengths, leave
/// no joint far from the straight segments, and end where a foot turns off or where fingers branch.
[[nodiscard]] Limb splitLimb(const JointTree& tree, std::span<const JointIndex> way, LimbKind kind);

/// Adds the fingers of a hand: a thumb and up to four more.
/// @param bones  bones of this side are written
void addFingersByShape(const JointTree& tree, const Reach& reach, bool left, BoneJoints& bones);

}  // namespace lorica
