#pragma once

#include "skinning/humanoid/humanoid_tree.h"

#include <span>
#include <vector>

namespace lorica {

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
