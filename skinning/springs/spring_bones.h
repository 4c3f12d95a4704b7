#pragma once

#include "skinning/skeleton.h"

#include <cstdint>
#include <span>
#include <string>
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

/// A joint that swings: a spring turns it back to its rest rotation while its tail keeps its momentum.
/// Terms of VRMC_springBone 1.0; its units are those of the joint's frame: scales at rest make metres of them
/// (https://github.com/vrm-c/vrm-specification/blob/master/specification/VRMC_springBone-1.0/README.md).
struct SpringJoint {
  JointIndex joint = 0;  ///< that swings
  /// The end that swings, in the joint's frame: the next joint of the chain at rest, or a virtual one. Not 0.
  Vec3 tail{0.0, 0.1, 0.0};
  double stiffness = 1.0;           ///< pull back to the rest direction [units/s], at least 0; see SpringSimulation
  double gravityPower = 0.0;        ///< pull along gravityDir, the same unit
  Vec3 gravityDir{0.0, -1.0, 0.0};  ///< world, of any length
  double dragForce = 0.4;           ///< share of the speed that is lost in each step, 0 to 1
  double hitRadius = 0.0;           ///< of the ball around the tail that collides [units], at least 0
};

/// Joints that swing together, each below the one before it or beside it, such as a strand of hair.
struct SpringChain {
  std::string name;                 ///< in the file; may be empty
  std::vector<SpringJoint> joints;  ///< at least one; parents precede children
  JointIndex center = kNoJoint;     ///< momentum is relative to this joint; kNoJoint = to the world
  std::vector<int> colliderGroups;  ///< indices into SpringBones::colliderGroups
};

/// What springs are kept out of.
enum class SpringColliderShape : std::uint8_t {
  kSphere,
  kCapsule,
  kPlane,          ///< keeps tails on the side of its normal
  kInsideSphere,   ///< keeps tails inside
  kInsideCapsule,  ///< keeps tails inside
};

/// A shape on a joint that tails stay out of. Planes and insides come from VRMC_springBone_extended_collider 1.0.
struct SpringCollider {
  JointIndex joint = 0;                                      ///< that it moves with
  SpringColliderShape shape = SpringColliderShape::kSphere;  ///< says what the numbers below mean
  Vec3 offset = Vec3::Zero();   ///< centre, first end of a capsule, or a point of a plane, in the joint's frame
  Vec3 tail = Vec3::Zero();     ///< second end of a capsule, in the joint's frame
  Vec3 normal = Vec3::UnitZ();  ///< of a plane, in the joint's frame
  double radius = 0.0;          ///< in the unit of the joint's frame, at least 0
};

/// What moves by itself in a character: springs, what they collide with, and joints that follow others.
struct SpringBones {
  std::vector<SpringChain> chains;               ///< strands of hair, tails, skirts
  std::vector<SpringCollider> colliders;         ///< what they stay out of
  std::vector<std::vector<int>> colliderGroups;  ///< indices into colliders
  std::vector<NodeConstraint> constraints;       ///< in an order in which they can be applied, see orderConstraints()

  /// Nothing swings and nothing follows
  [[nodiscard]] bool empty() const { return chains.empty() && constraints.empty(); }
  /// Number of joints that swing.
  [[nodiscard]] int springCount() const;
};

/// Checks that joints and indices exist, that numbers are finite and in range, that no joint swings in two ways, that a
/// chain's centre does not swing with it, and that constraints are not cyclic.
/// @return success, or one sentence with element, found and expected
[[nodiscard]] Result<void> checkSprings(const Skeleton& skeleton, const SpringBones& springs);

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
