#include "skinning/humanoid/humanoid_tree.h"

#include <algorithm>

namespace lorica {

JointTree::JointTree(const Skeleton& skeleton) {
  const std::size_t count = skeleton.joints().size();
  std::vector<Affine3> worldFromJoint(count);
  computeWorldFromJoint(skeleton, restPose(skeleton), worldFromJoint);
  parent_.reserve(count);
  position_.reserve(count);
  children_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const JointIndex parent = skeleton.joints()[i].parent;
    parent_.push_back(parent);
    position_.push_back(worldFromJoint[i].translation());
    if (parent != kNoJoint) children_[at(parent)].push_back(i);
  }

  // Sizes from the leaves up, then numbers from the roots down: no recursion, because a file may contain a very long
  // chain.
  std::vector<int> size(count, 1);
  for (std::size_t i = count; i-- > 0;) {
    if (parent_[i] != kNoJoint) size[at(parent_[i])] += size[i];
  }
  entered_.resize(count);
  left_.resize(count);
  int nextRoot = 0;
  std::vector<int> nextChild(count);
  for (std::size_t i = 0; i < count; ++i) {
    int& next = parent_[i] == kNoJoint ? nextRoot : nextChild[at(parent_[i])];
    entered_[i] = next;
    next += size[i];
    left_[i] = next;
    nextChild[i] = entered_[i] + 1;
  }
}

bool JointTree::isBelow(JointIndex joint, JointIndex ancestor) const {
  return joint != kNoJoint && joint != ancestor && entered_[at(ancestor)] <= entered_[at(joint)] &&
         entered_[at(joint)] < left_[at(ancestor)];
}

JointIndex JointTree::commonAncestor(JointIndex a, JointIndex b) const {
  if (a == kNoJoint) return b;
  if (b == kNoJoint) return a;
  while (a != kNoJoint && !isBelowOrSame(b, a)) a = parent(a);
  return a;
}

std::vector<JointIndex> JointTree::pathBelow(JointIndex top, JointIndex bottom) const {
  std::vector<JointIndex> path;
  for (JointIndex joint = bottom; joint != top && joint != kNoJoint; joint = parent(joint)) path.push_back(joint);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace lorica
