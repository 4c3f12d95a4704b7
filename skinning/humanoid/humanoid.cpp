#include "skinning/humanoid/humanoid.h"

#include "skinning/humanoid/humanoid_limbs.h"
#include "skinning/humanoid/humanoid_names.h"
#include "skinning/humanoid/humanoid_shape.h"
#include "skinning/humanoid/humanoid_words.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

using enum HumanBone;

/// Two joints at mirrored places, the left one (at +X) first, whose parents are not.
struct MirroredTops {
  std::array<JointIndex, 2> tops{};
  JointIndex branch = kNoJoint;  ///< the lowest joint that carries both
  double lowest = 0.0;           ///< height of the lowest joint of both limbs [m]
};

/// Joints that are compared with each other; larger skeletons have bones among the first.
constexpr JointIndex kMaxCompared = 1000;

[[nodiscard]] std::vector<MirroredTops> mirroredTops(const JointTree& tree, double size) {
  constexpr double kNear = 0.05;   // of the size
  constexpr double kApart = 0.02;  // of the size: joints in the middle have no other side
  const JointIndex count = std::min<JointIndex>(tree.jointCount(), kMaxCompared);
  std::vector<double> across;
  across.reserve(count);
  for (JointIndex joint = 0; joint < count; ++joint) across.push_back(tree.position(joint).x());
  std::nth_element(across.begin(), across.begin() + count / 2, across.end());
  const double middle = across[count / 2];

  const auto isMirrored = [&](JointIndex a, JointIndex b) {
    if (a == kNoJoint || b == kNoJoint || a == b) return false;
    const Vec3& left = tree.position(a);
    const Vec3 right(2.0 * middle - tree.position(b).x(), tree.position(b).y(), tree.position(b).z());
    return left.x() - middle > kApart * size && (left - right).norm() < kNear * size;
  };
  std::vector<double> lowest(tree.jointCount());
  for (JointIndex joint = tree.jointCount(); joint-- > 0;) {
    double& its = lowest[joint];
    its = tree.position(joint).y();
    for (const JointIndex child : tree.children(joint)) its = std::min(its, lowest[child]);
  }
  std::vector<MirroredTops> found;
  for (JointIndex a = 0; a < count; ++a) {
    for (JointIndex b = 0; b < count; ++b) {
      if (!isMirrored(a, b) || isMirrored(tree.parent(a), tree.parent(b))) continue;
      if (tree.isBelow(a, b) || tree.isBelow(b, a)) continue;
      found.push_back({{a, b}, tree.commonAncestor(a, b), std::min(lowest[a], lowest[b])});
    }
  }
  return found;
}

[[nodiscard]] int depthOf(const JointTree& tree, JointIndex joint) {
  int depth = 0;
  for (; joint != kNoJoint; joint = tree.parent(joint)) ++depth;
  return depth;
}

void writeLimb(const JointTree& tree, const Reach& reach, const MirroredTops& pair, LimbKind kind, BoneJoints& bones) {
  const bool leg = kind == LimbKind::kLeg;
  for (const std::size_t side : {0u, 1u}) {
    const Limb limb = splitLimb(tree, reach.wayDown(pair.tops[side]), kind);
    const auto write = [&](HumanBone left, JointIndex joint) {
      jointOf(bones, side == 0 ? left : mirrored(left)) = joint;
    };
    write(leg ? kLeftUpperLeg : kLeftUpperArm, limb.upper);
    write(leg ? kLeftLowerLeg : kLeftLowerArm, limb.lower);
    write(leg ? kLeftFoot : kLeftHand, limb.end);
    if (leg) write(kLeftToes, limb.beyond);
  }
}

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

HumanoidGuess suggestHumanoid(const Skeleton& skeleton) {
  HumanoidGuess guess = guessHumanoid(skeleton);
  if (guess[kHips] != kNoJoint) return guess;
  const JointTree tree(skeleton);
  Aabb box;
  for (JointIndex joint = 0; joint < tree.jointCount(); ++joint) box.extend(tree.position(joint));
  const std::vector<MirroredTops> pairs = mirroredTops(tree, box.diagonal());
  if (pairs.empty()) return guess;

  // The legs reach lowest; the arms start above them and share the most of the hierarchy with them.
  const MirroredTops legs = *std::min_element(
      pairs.begin(), pairs.end(), [](const MirroredTops& a, const MirroredTops& b) { return a.lowest < b.lowest; });
  const Reach reach(tree);
  BoneJoints bones;
  bones.fill(kNoJoint);
  writeLimb(tree, reach, legs, LimbKind::kLeg, bones);
  std::optional<MirroredTops> arms;
  int deepest = 0;
  for (const MirroredTops& pair : pairs) {
    const int depth = depthOf(tree, tree.commonAncestor(pair.branch, legs.branch));
    const bool apart = std::none_of(pair.tops.begin(), pair.tops.end(), [&](JointIndex top) {
      return tree.isBelowOrSame(top, legs.tops[0]) || tree.isBelowOrSame(top, legs.tops[1]);
    });
    const bool above = tree.position(pair.tops[0]).y() > tree.position(legs.tops[0]).y();
    if (!apart || !above || depth <= deepest) continue;
    deepest = depth;
    arms = pair;
  }
  if (arms) writeLimb(tree, reach, *arms, LimbKind::kArm, bones);
  jointOf(bones, kHips) = arms ? tree.commonAncestor(arms->branch, legs.branch) : legs.branch;
  if (jointOf(bones, kHips) == kNoJoint) return guess;
  addBonesByShape(tree, readJointNames(skeleton), bones);
  guess.jointOf = bones;
  guess.by = "a guess from joints at mirrored places";
  BoneDoubt all{{}, "a guess from joints at mirrored places"};
  for (std::size_t bone = 0; bone < bones.size(); ++bone) {
    if (bones[bone] != kNoJoint) all.bones.push_back(static_cast<HumanBone>(bone));
  }
  guess.doubts.push_back(std::move(all));
  return guess;
}

}  // namespace lorica
