#include "skinning/springs/spring_bones.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <fmt/format.h>

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

}  // namespace lorica
