#include "skinning/humanoid/humanoid.h"

#include "skinning/humanoid/humanoid_names.h"
#include "skinning/humanoid/humanoid_shape.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {

namespace {

using enum HumanBone;

/// Removes guessed bones that contradict the hierarchy: their joint is not below the joint of the parent bone.
void dropStrayBones(const JointTree& tree, const BoneJoints& given, BoneJoints& bones) {
  for (std::size_t bone = 0; bone < bones.size(); ++bone) {
    if (bones[bone] == kNoJoint || given[bone] != kNoJoint) continue;
    std::optional<HumanBone> above = parentBone(static_cast<HumanBone>(bone));
    while (above && jointOf(bones, *above) == kNoJoint) above = parentBone(*above);
    if (above && !tree.isBelow(bones[bone], jointOf(bones, *above))) bones[bone] = kNoJoint;
  }
}

}  // namespace

std::optional<HumanBone> parentBone(HumanBone bone) {
  switch (bone) {
    case kHips:
      return std::nullopt;
    case kLeftUpperLeg:
    case kRightUpperLeg:
      return kHips;
    case kLeftShoulder:
    case kRightShoulder:
      return kUpperChest;
    case kLeftThumbMetacarpal:
    case kLeftIndexProximal:
    case kLeftMiddleProximal:
    case kLeftRingProximal:
    case kLeftLittleProximal:
      return kLeftHand;
    case kRightThumbMetacarpal:
    case kRightIndexProximal:
    case kRightMiddleProximal:
    case kRightRingProximal:
    case kRightLittleProximal:
      return kRightHand;
    default:
      return static_cast<HumanBone>(static_cast<int>(bone) - 1);
  }
}

HumanoidGuess guessHumanoid(const Skeleton& skeleton) {
  BoneJoints given;
  for (std::size_t bone = 0; bone < given.size(); ++bone) given[bone] = skeleton.jointOf(static_cast<HumanBone>(bone));

  const JointTree tree(skeleton);
  const std::vector<JointName> names = readJointNames(skeleton);
  const NamedBones named = bonesByNames(tree, names, given);
  HumanoidGuess guess;
  guess.jointOf = given;
  if (!named.convention.empty()) {
    if (isFourLegged(tree, named.jointOf)) return guess;
    guess.jointOf = named.jointOf;
    dropSidewaysThighs(tree, guess.jointOf);
    addFingersByNames(tree, names, guess.jointOf);
    addBonesByShape(tree, names, guess.jointOf);
    dropStrayBones(tree, given, guess.jointOf);
    guess.by = fmt::format("names ({})", named.convention);
    return guess;
  }
  ShapedBones shaped = bonesByShape(tree, names);
  if (jointOf(shaped.jointOf, HumanBone::kHips) == kNoJoint) {
    const bool anyGiven = std::any_of(given.begin(), given.end(), [](JointIndex joint) { return joint != kNoJoint; });
    const NamedBones upper = anyGiven ? NamedBones{} : upperBodyByNames(tree, names);
    if (upper.convention.empty()) return guess;
    guess.jointOf = upper.jointOf;
    addFingersByNames(tree, names, guess.jointOf);
    dropStrayBones(tree, given, guess.jointOf);
    guess.by = fmt::format("names ({})", upper.convention);
    return guess;
  }
  // Bones that the skeleton already has take precedence; a shape that contradicts them is rejected.
  for (std::size_t bone = 0; bone < given.size(); ++bone) {
    if (given[bone] != kNoJoint && shaped.jointOf[bone] != given[bone]) return guess;
  }
  guess.jointOf = shaped.jointOf;
  guess.doubts = std::move(shaped.doubts);
  dropStrayBones(tree, given, guess.jointOf);
  for (BoneDoubt& doubt : guess.doubts) {
    std::erase_if(doubt.bones, [&](HumanBone bone) { return guess[bone] == kNoJoint; });
  }
  guess.by = "the skeleton's shape";
  return guess;
}

std::string inWords(const BoneDoubt& doubt) {
  std::vector<std::string_view> names;
  for (const HumanBone bone : doubt.bones) names.push_back(nameOf(bone));
  return fmt::format("{}: {}", fmt::join(names, ", "), doubt.reason);
}

Skeleton withBones(const Skeleton& skeleton, const HumanoidGuess& bones) {
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  for (Joint& joint : joints) joint.bone.reset();
  for (std::size_t bone = 0; bone < bones.jointOf.size(); ++bone) {
    const JointIndex joint = bones.jointOf[bone];
    if (joint == kNoJoint) continue;
    LORICA_CHECK(joint >= 0 && joint < skeleton.jointCount(), "the guess belongs to another skeleton");
    LORICA_CHECK(!joints[joint].bone, "a guess assigns at most one bone to each joint");
    joints[joint].bone = static_cast<HumanBone>(bone);
  }
  Result<Skeleton> result = Skeleton::create(std::move(joints));
  LORICA_CHECK(result.ok(), "only the bones changed");
  return std::move(*result);
}

}  // namespace lorica
