#include "player/part_colors.h"

#include "collision/live/part_bones.h"

#include <algorithm>

namespace lorica {
namespace {

constexpr PartIndex kBones =
    static_cast<PartIndex>(HumanBone::kRightHand) + 1;  // fingers have the colour of their hand

/// The bone at a joint or above it; of what has none the joint.
PartIndex colorOf(const Skeleton& skeleton, JointIndex joint) {
  for (JointIndex j = joint; j != kNoJoint; j = skeleton.joint(j).parent) {
    const auto bone = skeleton.joint(j).bone;
    if (bone && *bone <= HumanBone::kRightHand) return static_cast<PartIndex>(*bone);
  }
  return joint;
}

}  // namespace

std::vector<PartIndex> colorsOfParts(const Decomposition& decomposition, const Character& character) {
  std::vector<PartIndex> colors;
  for (const std::vector<JointShare>& joints : jointsOfParts(decomposition, character)) {
    PartIndex color = joints.empty() ? 0 : colorOf(character.skeleton, joints.front().joint);
    while (std::find(colors.begin(), colors.end(), color) != colors.end()) color += kBones;  // another of the bone
    colors.push_back(color);
  }
  return colors;
}

}  // namespace lorica
