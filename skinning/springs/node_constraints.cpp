#include "skinning/springs/node_constraints.h"

#include <algorithm>
#include <array>

namespace lorica {

namespace {

/// Finds an order by a depth-first search with a stack of its own: a file may have a hundred thousand levels.
///
/// Each joint has two nodes: its local rotation, and its transform in the world. The latter depends on the former and
/// on the parent's transform; the rotation depends on what the joint's constraint reads.
class ConstraintOrder {
 public:
  ConstraintOrder(const Skeleton& skeleton, std::span<const NodeConstraint> constraints)
      : skeleton_(skeleton),
        constraints_(constraints),
        constraintOf_(skeleton.joints().size(), -1),
        marks_(2 * skeleton.joints().size(), Mark::kNew),
        cyclic_(constraints.size(), 0) {
    for (std::size_t c = 0; c < constraints.size(); ++c) constraintOf_[constraints[c].joint] = c;
  }

  void search() {
    for (const NodeConstraint& constraint : constraints_) visit(rotationOf(constraint.joint));
  }
  /// Indices of the constraints, those of cycles left out.
  [[nodiscard]] const std::vector<std::size_t>& order() const { return order_; }
  [[nodiscard]] bool cyclic(std::size_t constraint) const { return cyclic_[constraint] != 0; }

 private:
  enum class Mark : char { kNew, kOpen, kDone };
  static constexpr std::size_t kNone = -1;
  struct Entry {
    std::size_t node;
    int next;  ///< which dependency comes next
  };

  [[nodiscard]] static std::size_t rotationOf(JointIndex joint) { return 2 * static_cast<std::size_t>(joint); }
  [[nodiscard]] static std::size_t worldOf(JointIndex joint) {
    return joint == kNoJoint ? kNone : 2 * static_cast<std::size_t>(joint) + 1;
  }

  /// A node depends on at most two others.
  [[nodiscard]] std::array<std::size_t, 2> dependencies(std::size_t node) const {
    const JointIndex joint = node / 2;
    const JointIndex parent = skeleton_.joint(joint).parent;
    if (node % 2 == 1) return {rotationOf(joint), worldOf(parent)};
    const int c = constraintOf_[joint];
    if (c < 0) return {kNone, kNone};
    const NodeConstraint& constraint = constraints_[c];
    if (constraint.kind == NodeConstraint::Kind::kAim) return {worldOf(constraint.source), worldOf(parent)};
    return {rotationOf(constraint.source), kNone};
  }

  void visit(std::size_t start) {
    if (marks_[start] != Mark::kNew) return;
    marks_[start] = Mark::kOpen;
    stack_.assign(1, {start, 0});
    while (!stack_.empty()) {
      Entry& top = stack_.back();
      if (top.next == 2) {
        marks_[top.node] = Mark::kDone;
        const int c = top.node % 2 == 0 ? constraintOf_[top.node / 2] : -1;
        if (c >= 0 && cyclic_[c] == 0) order_.push_back(c);
        stack_.pop_back();
        continue;
      }
      const std::size_t needed = dependencies(top.node)[top.next++];
      if (needed == kNone || marks_[needed] == Mark::kDone) continue;
      if (marks_[needed] == Mark::kOpen) {
        dropLast();
      } else {
        marks_[needed] = Mark::kOpen;
        stack_.push_back({needed, 0});
      }
    }
  }

  /// The stack ends with a cycle. Without constraints there are none, so the last constraint on it is in the cycle.
  void dropLast() {
    for (std::size_t i = stack_.size(); i-- > 0;) {
      const std::size_t node = stack_[i].node;
      if (node % 2 == 1 || constraintOf_[node / 2] < 0) continue;
      cyclic_[constraintOf_[node / 2]] = 1;
      return;
    }
  }

  const Skeleton& skeleton_;
  std::span<const NodeConstraint> constraints_;
  std::vector<int> constraintOf_;  // of each joint, or -1
  std::vector<Mark> marks_;
  std::vector<char> cyclic_;
  std::vector<Entry> stack_;
  std::vector<std::size_t> order_;
};

/// @return worldFromJoint in a pose
[[nodiscard]] Affine3 worldTransform(const Skeleton& skeleton, std::span<const JointTransform> pose, JointIndex joint) {
  Affine3 world = Affine3::Identity();
  for (; joint != kNoJoint; joint = skeleton.joint(joint).parent) world = pose[joint].matrix() * world;
  return world;
}

/// The product of the rotations alone: scales of the joints above do not turn anything.
[[nodiscard]] Quat worldRotation(const Skeleton& skeleton, std::span<const JointTransform> pose, JointIndex joint) {
  Quat world = Quat::Identity();
  for (; joint != kNoJoint; joint = skeleton.joint(joint).parent) world = pose[joint].rotation * world;
  return world;
}

/// The rotation that a joint with the whole weight has.
[[nodiscard]] Quat followed(const Skeleton& skeleton, const NodeConstraint& constraint,
                            std::span<const JointTransform> pose) {
  const Quat& rest = skeleton.joint(constraint.joint).rest.rotation;
  const Quat& sourceRest = skeleton.joint(constraint.source).rest.rotation;
  const Quat& source = pose[constraint.source].rotation;
  switch (constraint.kind) {
    case NodeConstraint::Kind::kRotation:
      return rest * sourceRest.conjugate() * source;
    case NodeConstraint::Kind::kRoll: {
      // What the source has turned, seen from the joint at rest; the part that moves the axis is taken out again.
      const Quat turned = rest.conjugate() * source * sourceRest.conjugate() * rest;
      return rest * rotationBetween(turned * constraint.axis, constraint.axis) * turned;
    }
    case NodeConstraint::Kind::kAim: {
      const JointIndex parent = skeleton.joint(constraint.joint).parent;
      const Quat worldFromParent = worldRotation(skeleton, pose, parent);
      const Vec3 towards = worldTransform(skeleton, pose, constraint.source).translation() -
                           worldTransform(skeleton, pose, parent) * pose[constraint.joint].translation;
      if (!(towards.squaredNorm() > 1e-18)) return rest;  // the source lies on the joint
      const Quat turn = rotationBetween(worldFromParent * rest * constraint.axis, towards);
      return worldFromParent.conjugate() * turn * worldFromParent * rest;
    }
  }
  return rest;
}

}  // namespace

std::vector<JointIndex> orderConstraints(const Skeleton& skeleton, std::vector<NodeConstraint>& constraints) {
  ConstraintOrder order(skeleton, constraints);
  order.search();
  std::vector<JointIndex> cyclic;
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    if (order.cyclic(c)) cyclic.push_back(constraints[c].joint);
  }
  std::vector<NodeConstraint> sorted;
  sorted.reserve(order.order().size());
  for (const std::size_t c : order.order()) sorted.push_back(constraints[c]);
  constraints = std::move(sorted);
  return cyclic;
}

void applyConstraints(const Skeleton& skeleton, std::span<const NodeConstraint> constraints,
                      std::span<JointTransform> pose) {
  for (const NodeConstraint& constraint : constraints) {
    const Quat& rest = skeleton.joint(constraint.joint).rest.rotation;
    const Quat target = followed(skeleton, constraint, pose);
    pose[constraint.joint].rotation = rest.slerp(constraint.weight, target).normalized();
  }
}

}  // namespace lorica
