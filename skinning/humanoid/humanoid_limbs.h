#pragma once

#include "skinning/humanoid/humanoid_tree.h"

#include <span>
#include <vector>

namespace lorica {

/// For each joint the length of the longest way down from it [m], and the child on that way (kNoJoint at a leaf).
struct Reach {
  std::vector<double> length;
  std::vector<JointIndex> next;
  std::vector<int> size;  ///< joints of its subtree, itself included

  explicit Reach(const JointTree& tree);
  /// From a joint along the longest way to its leaf.
  [[nodiscard]] std::vector<JointIndex> wayDown(JointIndex joint) const;
};

/// The joints of a limb: shoulder or hip, elbow or knee, wrist or ankle; kNoJoint where the limb is too short.
struct Limb {
  JointIndex upper = kNoJoint;
  JointIndex lower = kNoJoint;
  JointIndex end = kNoJoint;
  JointIndex beyond = kNoJoint;  ///< the next joint after the end: of a leg its toes
};

enum class LimbKind { kLeg, kArm };

/// Chooses three joints of a way down a limb that may hold more: those that split it into two like lengths, leave
/// nothing beside the line, and end where a foot turns off or where fingers part.
[[nodiscard]] Limb splitLimb(const JointTree& tree, std::span<const JointIndex> way, LimbKind kind);

/// The fingers on a hand: a thumb and up to four more.
/// @param bones  those of this side are written
void addFingersByShape(const JointTree& tree, const Reach& reach, bool left, BoneJoints& bones);

}  // namespace lorica
