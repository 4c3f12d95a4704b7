#pragma once

#include "geometry/counts.h"
#include "skinning/humanoid/humanoid_tree.h"
#include "skinning/humanoid/humanoid_words.h"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

namespace lorica {

struct NamedBones {
  BoneJoints jointOf{};
  std::string convention;  ///< empty if no convention finds hips and both legs
};

/// Finds the bones by the convention whose names match the most bones. A name counts only if the hierarchy agrees:
/// lower leg below upper leg, all below the hips, the same main bones left and right.
/// @param given  bones that are already known; they are kept
[[nodiscard]] NamedBones bonesByNames(const JointTree& tree, std::span<const JointName> names, const BoneJoints& given);

/// The same for a skeleton that lacks one or both legs: two arms on a trunk.
[[nodiscard]] NamedBones upperBodyByNames(const JointTree& tree, std::span<const JointName> names);

/// The parents of joints that a file lists without a hierarchy, by the bones that their names mean: a chain of names
/// that are numbered, else the nearest bone for what is none.
/// @param flat  the joints
/// @return one for each of them, kNoJoint for the hips; empty if the names do not give hips, legs and trunk or arms
[[nodiscard]] std::vector<JointIndex> parentsByNames(const JointTree& tree, std::span<const JointName> names,
                                                     std::span<const JointIndex> flat);

/// Adds the fingers below known hands by their names, in any convention.
void addFingersByNames(const JointTree& tree, std::span<const JointName> names, BoneJoints& bones);

/// Assigns spine, chest and upper chest to the joints of the trunk, given from the hips up: of more than three the
/// first, the middle and the last.
void assignTrunk(std::span<const JointIndex> fromHipsUp, BoneJoints& bones);

[[nodiscard]] inline JointIndex& jointOf(BoneJoints& bones, HumanBone bone) {
  return bones[ordinalOf(bone)];
}
[[nodiscard]] inline JointIndex jointOf(const BoneJoints& bones, HumanBone bone) {
  return bones[ordinalOf(bone)];
}

/// Whether a joint is one of the bones.
[[nodiscard]] inline bool isUsed(const BoneJoints& bones, JointIndex joint) {
  return std::find(bones.begin(), bones.end(), joint) != bones.end();
}

/// The lowest joint that carries both arms and the head; kNoJoint if there are neither arms nor head.
[[nodiscard]] JointIndex topOfTrunk(const JointTree& tree, const BoneJoints& bones);

/// The joints from below the hips to the top of the trunk that carry no leg, are not yet a bone and are not a helper.
[[nodiscard]] std::vector<JointIndex> trunkJoints(const JointTree& tree, std::span<const JointName> names,
                                                  const BoneJoints& bones);

}  // namespace lorica
