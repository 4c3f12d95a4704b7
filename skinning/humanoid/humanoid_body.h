#pragma once

#include "skinning/humanoid/humanoid.h"
#include "skinning/humanoid/humanoid_tree.h"
#include "skinning/humanoid/humanoid_words.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Two limbs that may be legs or arms.
struct LimbPair {
  JointIndex branch = kNoJoint;  ///< the lowest joint that carries both
  std::array<JointIndex, 2> tops{};
  std::array<std::vector<JointIndex>, 2> ways;  ///< down the limbs; of matched pairs as long as each other
  double length = 0.0;                          ///< of the shorter, or of what both have [m]
  bool matched = false;                         ///< the ways have the same distances from joint to joint
};

/// Legs and arms of a skeleton, found by the shape of its rest pose.
struct BodyShape {
  LimbPair legs;
  LimbPair arms;
  std::array<Limb, 2> leg;
  std::array<Limb, 2> arm;
  JointIndex hips = kNoJoint;
  JointIndex head = kNoJoint;  ///< first joint of the path to the head
  Vec3 up = Vec3::Zero();      ///< from the legs to the arms, unit
  bool leftLegFirst = true;
  bool leftArmFirst = true;
  std::vector<BoneDoubt> doubts;
};

/// The most plausible body: two limbs that point away from the trunk, two at its other end, a head between them. Limbs
/// that are alike are preferred; else what both have in common counts; else two arms that only start alike.
[[nodiscard]] std::optional<BodyShape> findBody(const JointTree& tree, const Reach& reach,
                                                std::span<const JointName> names);

/// The child of the chest that leads up and carries neither an arm nor a leg.
/// @param taken  joints of arms and legs
[[nodiscard]] JointIndex findHead(const JointTree& tree, const Reach& reach, std::span<const JointName> names,
                                  JointIndex chest, const Vec3& up, std::span<const JointIndex> taken);

}  // namespace lorica
