#pragma once

#include "skinning/humanoid/humanoid_tree.h"
#include "skinning/humanoid/humanoid_words.h"

#include <span>
#include <vector>

namespace lorica {

struct ShapedBones {
  BoneJoints jointOf{};  ///< all kNoJoint if the skeleton is not a humanoid
  std::vector<BoneDoubt> doubts;
};

/// Finds the bones only by the shape of the skeleton in its rest pose: two similar limbs that point away from the trunk
/// are legs, two similar limbs at its other end are arms, with a head between them, see findBody(). The skeleton may
/// have any orientation. Left is determined by side words in the names, else by the toes, else by the knees, else it is
/// at +X.
[[nodiscard]] ShapedBones bonesByShape(const JointTree& tree, std::span<const JointName> names);

/// Adds missing bones of a skeleton with known hips and legs by its shape: trunk, neck, head, collar bones, feet, toes,
/// hands and fingers.
void addBonesByShape(const JointTree& tree, std::span<const JointName> names, BoneJoints& bones);

/// Replaces a puppet's thigh that only leads sideways from the middle to the leg by the next joint. Rotated like a
/// thigh, it would fold the leg under the body.
void dropSidewaysThighs(const JointTree& tree, BoneJoints& bones);

/// Whether arms and legs point the same way, across the trunk: an animal, whatever the names of its joints.
[[nodiscard]] bool isFourLegged(const JointTree& tree, const BoneJoints& bones);

}  // namespace lorica
