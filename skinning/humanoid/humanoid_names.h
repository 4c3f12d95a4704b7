#pragma once

#include "skinning/humanoid/humanoid_tree.h"
#include "skinning/humanoid/humanoid_words.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

struct NamedBones {
  BoneJoints jointOf{};
  std::string convention;  ///< empty when no convention gives hips and both legs
};

/// The bones by the convention whose names fit the most of them. A name counts where the hierarchy agrees: lower leg
/// below upper leg, all below the hips, the same main bones left and right.
/// @param given  bones that are known already; they are kept
[[nodiscard]] NamedBones bonesByNames(const JointTree& tree, std::span<const JointName> names, const BoneJoints& given);

/// The same of a body that lacks legs, or has but one: two arms on a trunk.
[[nodiscard]] NamedBones upperBodyByNames(const JointTree& tree, std::span<const JointName> names);

/// Adds the fingers that names tell, in whatever convention, below hands that are known.
void addFingersByNames(const JointTree& tree, std::span<const JointName> names, BoneJoints& bones);

/// Spine, chest and upper chest of joints of the trunk, from the hips up: of more than three the first, the middle and
/// the last.
void assignTrunk(std::span<const JointIndex> fromHipsUp, BoneJoints& bones);

[[nodiscard]] inline JointIndex& jointOf(BoneJoints& bones, HumanBone bone) {
  return bones[static_cast<std::size_t>(bone)];
}
[[nodiscard]] inline JointIndex jointOf(const BoneJoints& bones, HumanBone bone) {
  return bones[static_cast<std::size_t>(bone)];
}

/// The joint that both arms and the head hang on; kNoJoint where there is none of them.
[[nodiscard]] JointIndex topOfTrunk(const JointTree& tree, const BoneJoints& bones);

/// The joints from below the hips to the top of the trunk that carry no leg, are no bone yet and no helper.
[[nodiscard]] std::vector<JointIndex> trunkJoints(const JointTree& tree, std::span<const JointName> names,
                                                  const BoneJoints& bones);

}  // namespace lorica
