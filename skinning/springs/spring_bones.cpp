#include "skinning/springs/spring_bones.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace lorica {

namespace {

constexpr int kMaxCenterSteps = 10'000'000;  // from centres up to their roots, in all

[[nodiscard]] bool exists(const Skeleton& skeleton, JointIndex joint) {
  return joint >= 0 && joint < skeleton.jointCount();
}

[[nodiscard]] Error noJoint(const std::string& who, JointIndex joint, const Skeleton& skeleton) {
  return invalidArgument("{}: joint {} does not exist, expected 0 to {}", who, joint, skeleton.jointCount() - 1);
}

[[nodiscard]] bool atLeast0(double number) {
  return number >= 0.0 && std::isfinite(number);
}

[[nodiscard]] Result<void> checkJoint(const Skeleton& skeleton, const SpringJoint& spring, const std::string& who) {
  if (!exists(skeleton, spring.joint)) return noJoint(who, spring.joint, skeleton);
  if (!spring.tail.allFinite() || spring.tail.isZero(0.0))
    return invalidArgument(who + ": its tail is at 0 or not finite");
  if (!atLeast0(spring.stiffness) || !atLeast0(spring.hitRadius) || !(spring.dragForce >= 0.0) ||
      !(spring.dragForce <= 1.0) || !std::isfinite(spring.gravityPower) || !spring.gravityDir.allFinite()) {
    return invalidArgument(
        "{}: stiffness {}, hit radius {}, drag {}, gravity {}; expected finite numbers, the first "
        "two at least 0, the drag from 0 to 1",
        who, spring.stiffness, spring.hitRadius, spring.dragForce, spring.gravityPower);
  }
  return {};
}

[[nodiscard]] Result<void> checkColliders(const Skeleton& skeleton, const SpringBones& springs) {
  for (std::size_t c = 0; c < springs.colliders.size(); ++c) {
    const SpringCollider& collider = springs.colliders[c];
    const std::string who = fmt::format("collider {}", c);
    if (!exists(skeleton, collider.joint)) return noJoint(who, collider.joint, skeleton);
    if (!collider.offset.allFinite() || !collider.tail.allFinite() || !collider.normal.allFinite() ||
        !atLeast0(collider.radius)) {
      return invalidArgument("{}: radius {}, expected finite numbers and a radius of at least 0", who, collider.radius);
    }
  }
  for (std::size_t g = 0; g < springs.colliderGroups.size(); ++g) {
    for (const int c : springs.colliderGroups[g]) {
      if (c >= 0 && c < countOf(springs.colliders)) continue;
      return invalidArgument("collider group {}: collider {} does not exist, expected one of {}", g, c,
                             springs.colliders.size());
    }
  }
  return {};
}

[[nodiscard]] Result<void> checkConstraints(const Skeleton& skeleton, const SpringBones& springs) {
  if (springs.constraints.size() > kMaxNodeConstraints) {
    return invalidArgument("{} constraints, expected at most {}", springs.constraints.size(), kMaxNodeConstraints);
  }
  std::vector<char> follows(skeleton.joints().size(), 0);
  for (std::size_t c = 0; c < springs.constraints.size(); ++c) {
    const NodeConstraint& constraint = springs.constraints[c];
    const std::string who = fmt::format("constraint {}", c);
    for (const JointIndex joint : {constraint.joint, constraint.source}) {
      if (!exists(skeleton, joint)) return noJoint(who, joint, skeleton);
    }
    if (follows[constraint.joint] != 0) return invalidArgument("{}: joint {} has another", who, constraint.joint);
    follows[constraint.joint] = 1;
    if (!(constraint.weight >= 0.0 && constraint.weight <= 1.0) || !constraint.axis.allFinite() ||
        std::abs(constraint.axis.norm() - 1.0) > 1e-6) {
      return invalidArgument("{}: weight {}, expected 0 to 1 and an axis of length 1", who, constraint.weight);
    }
  }
  std::vector<NodeConstraint> sorted = springs.constraints;
  const std::vector<JointIndex> cyclic = orderConstraints(skeleton, sorted);
  if (cyclic.empty()) return {};
  return invalidArgument("the constraint of joint {} depends on itself", cyclic.front());
}

}  // namespace

int SpringBones::springCount() const {
  std::size_t count = 0;
  for (const SpringChain& chain : chains) count += chain.joints.size();
  return count;
}

Result<void> checkSprings(const Skeleton& skeleton, const SpringBones& springs) {
  if (springs.colliders.size() > kMaxSpringColliders) {
    return invalidArgument("{} colliders, expected at most {}", springs.colliders.size(), kMaxSpringColliders);
  }
  LORICA_TRY_DO(checkColliders(skeleton, springs));

  std::vector<int> chainOf(skeleton.joints().size(), -1);
  std::size_t count = 0;
  std::size_t pairs = 0;
  for (std::size_t c = 0; c < springs.chains.size(); ++c) {
    const SpringChain& chain = springs.chains[c];
    if (chain.joints.empty()) return invalidArgument("chain {}: has no joints, expected at least one", c);
    count += chain.joints.size();
    for (std::size_t j = 0; j < chain.joints.size(); ++j) {
      const std::string who = fmt::format("chain {}, joint {}", c, j);
      LORICA_TRY_DO(checkJoint(skeleton, chain.joints[j], who));
      int& owner = chainOf[chain.joints[j].joint];
      if (owner != -1) return invalidArgument("{}: swings in chain {} already", who, owner);
      owner = c;
    }
    std::size_t colliders = 0;
    for (const int g : chain.colliderGroups) {
      if (g < 0 || g >= countOf(springs.colliderGroups)) {
        return invalidArgument("chain {}: collider group {} does not exist, expected one of {}", c, g,
                               springs.colliderGroups.size());
      }
      colliders += springs.colliderGroups[g].size();
    }
    pairs += colliders * chain.joints.size();
    if (count > kMaxSprings || pairs > kMaxSpringPairs) {
      return invalidArgument(
          "{} joints swing, which makes {} pairs with colliders up to chain {}; expected at most "
          "{} and {}",
          count, pairs, c, kMaxSprings, kMaxSpringPairs);
    }
  }
  int centerSteps = 0;
  for (std::size_t c = 0; c < springs.chains.size(); ++c) {
    const JointIndex center = springs.chains[c].center;
    if (center == kNoJoint) continue;
    if (!exists(skeleton, center)) return noJoint(fmt::format("chain {}: centre", c), center, skeleton);
    for (JointIndex j = skeleton.joint(center).parent; j != kNoJoint; j = skeleton.joint(j).parent) {
      if (++centerSteps > kMaxCenterSteps)
        return invalidArgument("the centres of the chains lie too deep in the skeleton");
      if (chainOf[j] != static_cast<int>(c)) continue;
      return invalidArgument("chain {}: its centre, joint {}, swings with it", c, center);
    }
  }
  return checkConstraints(skeleton, springs);
}

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
