#pragma once

#include "skinning/skeleton.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// A joint whose rotation follows another joint, see VRMC_node_constraint 1.0
/// (https://github.com/vrm-c/vrm-specification/blob/master/specification/VRMC_node_constraint-1.0/README.md).
struct NodeConstraint {
  /// What the follower takes over.
  enum class Kind : std::uint8_t {
    kRoll,      ///< turns as the source does, about one axis only: twist bones
    kAim,       ///< turns one axis towards the source: sleeves
    kRotation,  ///< turns as the source does, each in its own frame: helper arms
  };
  Kind kind = Kind::kRotation;  ///< what is taken over
  JointIndex joint = 0;         ///< that follows
  JointIndex source = 0;        ///< that it follows
  Vec3 axis = Vec3::UnitX();    ///< of roll and aim: a unit axis of the joint's frame
  double weight = 1.0;          ///< from the rest rotation, 0, to the one that follows, 1
};

/// Sorts constraints so that each comes after those that it depends on, and removes those that depend on themselves. An
/// aim depends on everything that moves its source or its joint's parent, the others on their source's own rotation.
/// @param constraints  joints of the skeleton; at most one for each joint
/// @return the joints whose constraints were removed, because they closed a cycle
[[nodiscard]] std::vector<JointIndex> orderConstraints(const Skeleton& skeleton,
                                                       std::vector<NodeConstraint>& constraints);

/// Sets the rotations of joints that follow others. Rest rotations are the skeleton's. Allocates nothing.
/// @param constraints  in the order of orderConstraints()
/// @param pose         local transforms of the skeleton, input and output
void applyConstraints(const Skeleton& skeleton, std::span<const NodeConstraint> constraints,
                      std::span<JointTransform> pose);

}  // namespace lorica
