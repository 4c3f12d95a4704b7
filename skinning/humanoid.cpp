#include "skinning/humanoid.h"

#include "skinning/humanoid_names.h"

#include <fmt/format.h>

namespace lorica {

HumanoidGuess guessHumanoid(const Skeleton& skeleton) {
  BoneJoints given;
  for (std::size_t bone = 0; bone < given.size(); ++bone) given[bone] = skeleton.jointOf(static_cast<HumanBone>(bone));

  const JointTree tree(skeleton);
  const std::vector<JointName> names = readJointNames(skeleton);
  const NamedBones named = bonesByNames(tree, names, given);
  HumanoidGuess guess;
  guess.jointOf = named.jointOf;
  if (!named.convention.empty()) {
    addFingersByNames(tree, names, guess.jointOf);
    guess.by = fmt::format("names ({})", named.convention);
  }
  return guess;
}

Skeleton withBones(const Skeleton& skeleton, const HumanoidGuess& bones) {
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  for (Joint& joint : joints) joint.bone.reset();
  for (std::size_t bone = 0; bone < bones.jointOf.size(); ++bone) {
    const JointIndex joint = bones.jointOf[bone];
    if (joint == kNoJoint) continue;
    CHECK(joint >= 0 && joint < skeleton.jointCount(), "a guess of another skeleton");
    CHECK(!joints[static_cast<std::size_t>(joint)].bone, "a guess gives each joint one bone at most");
    joints[static_cast<std::size_t>(joint)].bone = static_cast<HumanBone>(bone);
  }
  Result<Skeleton> result = Skeleton::create(std::move(joints));
  CHECK(result.ok(), "only the bones changed");
  return std::move(*result);
}

}  // namespace lorica
