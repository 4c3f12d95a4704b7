#pragma once

#include "skinning/humanoid/humanoid_tree.h"
#include "skinning/humanoid/humanoid_words.h"

#include <span>
#include <vector>

namespace lorica {

/// The bones by the shape of the skeleton in its rest pose alone: two like limbs that hang against the trunk are legs,
/// two like limbs on the other end of it arms, with a head between them. However it lies: nothing asks where up is.
/// Left is told by what the names say of sides, else by toes, else by knees, else it is at +X.
/// @return all kNoJoint when this is no humanoid
[[nodiscard]] BoneJoints bonesByShape(const JointTree& tree, std::span<const JointName> names);

/// Adds what a skeleton with known hips and legs lacks and its shape tells: trunk, neck, head, collar bones, feet,
/// toes, hands and fingers.
void addBonesByShape(const JointTree& tree, std::span<const JointName> names, BoneJoints& bones);

/// A puppet's thigh that only leads sideways from the middle to the leg is no thigh: the next joint is. Moved so, it
/// would fold the leg under the body.
void dropSidewaysThighs(const JointTree& tree, BoneJoints& bones);

/// Whether arms and legs both hang down from a lying trunk: an animal, whatever its joints are called.
[[nodiscard]] bool isFourLegged(const JointTree& tree, const BoneJoints& bones);

}  // namespace lorica
