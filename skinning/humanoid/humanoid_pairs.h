#pragma once

#include "skinning/humanoid/humanoid_limbs.h"

#include <array>
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

/// Pairs of limbs on one joint whose longest paths have about the same length and number of joints, in descending
/// length.
[[nodiscard]] std::vector<LimbPair> regularPairs(const JointTree& tree, const Reach& reach);

/// Pairs of limbs on one joint or along one trunk that have a way down in common: the same distances from joint to
/// joint, whatever else hangs on either of them, such as a tool in one hand. In descending length.
[[nodiscard]] std::vector<LimbPair> matchedPairs(const JointTree& tree, const Reach& reach);

/// Pairs of limbs that start where those of the other side would, but are not alike: one arm is a tool.
/// @param legs  define the plane between left and right
[[nodiscard]] std::vector<LimbPair> lopsidedPairs(const JointTree& tree, const Reach& reach, const LimbPair& legs);

}  // namespace lorica
