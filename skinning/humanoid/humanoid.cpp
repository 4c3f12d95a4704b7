#include "skinning/humanoid/humanoid.h"

#include "skinning/humanoid/humanoid_body.h"
#include "skinning/humanoid/humanoid_names.h"
#include "skinning/humanoid/humanoid_tree.h"
#include "skinning/humanoid/humanoid_words.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace lorica {
namespace {

struct ShapedBones {
  BoneJoints jointOf{};  ///< all kNoJoint if the skeleton is not a humanoid
  std::vector<BoneDoubt> doubts;
};

using enum HumanBone;

void writeHead(const JointTree& tree, JointIndex first, const Vec3& up, double trunkLength, BoneJoints& bones) {
  // The chain up to the joint where face and hair branch off.
  std::vector<JointIndex> way = {first};
  while (tree.children(way.back()).size() == 1 && way.size() < 6) way.push_back(tree.children(way.back()).front());
  const bool isLeaf = tree.children(way.back()).empty();
  const auto segment = [&](std::size_t i) { return tree.distance(way[i], way[i - 1]); };
  // The last joint of an unbranched chain may be the top of the head: a head is longer than a neck.
  if (isLeaf && way.size() == 2 && segment(1) > 0.3 * trunkLength) way.pop_back();
  if (isLeaf && way.size() > 2 && segment(way.size() - 1) > 1.5 * segment(way.size() - 2)) way.pop_back();
  // What is not above the head is no head: a hat, a jaw.
  while (way.size() > 1 && isLeaf && (tree.position(way.back()) - tree.position(way[way.size() - 2])).dot(up) <= 0.0) {
    way.pop_back();
  }
  jointOf(bones, kHead) = way.back();
  if (way.size() > 1) jointOf(bones, kNeck) = way.front();
}

void writeShoulder(const JointTree& tree, JointIndex chest, HumanBone shoulder, JointIndex upperArm,
                   std::span<const JointName> names, BoneJoints& bones) {
  const double armLength = std::max(1e-9, tree.distance(upperArm, chest));
  for (const JointIndex joint : tree.pathBelow(chest, upperArm)) {
    if (joint == upperArm) return;
    const bool apart = tree.distance(joint, upperArm) > 0.05 * armLength;
    const bool carriesHead = tree.isBelow(jointOf(bones, kHead), joint);
    if (!apart || isUsed(bones, joint) || carriesHead || isHelper(names[joint])) continue;
    jointOf(bones, shoulder) = joint;
    return;
  }
}

[[nodiscard]] HumanBone onSide(HumanBone bone, bool left) {
  return left ? bone : mirrored(bone);
}

/// The middle between a left bone and its mirror image; none if one of them is missing.
[[nodiscard]] std::optional<Vec3> middleOf(const JointTree& tree, const BoneJoints& bones, HumanBone left) {
  const JointIndex a = jointOf(bones, left), b = jointOf(bones, mirrored(left));
  if (a == kNoJoint || b == kNoJoint) return std::nullopt;
  return 0.5 * (tree.position(a) + tree.position(b));
}

/// From between the thighs to between the arms; without arms to the head; else opposite to the legs [m].
[[nodiscard]] Vec3 trunkAxis(const JointTree& tree, const BoneJoints& bones, const Vec3& legTop) {
  if (const std::optional<Vec3> arms = middleOf(tree, bones, kLeftUpperArm)) return *arms - legTop;
  if (jointOf(bones, kHead) != kNoJoint) return tree.position(jointOf(bones, kHead)) - legTop;
  for (const HumanBone end : {kLeftFoot, kLeftLowerLeg}) {
    if (const std::optional<Vec3> legs = middleOf(tree, bones, end)) return legTop - *legs;
  }
  return Vec3::Zero();
}

/// Hands and feet that have a sibling at the same place, and fingers, whose order depends on how the hand is held.
void addEndDoubts(const JointTree& tree, const BoneJoints& bones, std::vector<BoneDoubt>& doubts) {
  constexpr double kSamePlace = 0.01;  // of the bone above
  std::vector<HumanBone> ends;
  for (const auto& [end, above] : {std::pair(kLeftHand, kLeftLowerArm), std::pair(kRightHand, kRightLowerArm),
                                   std::pair(kLeftFoot, kLeftLowerLeg), std::pair(kRightFoot, kRightLowerLeg)}) {
    const JointIndex joint = jointOf(bones, end);
    if (joint == kNoJoint) continue;
    const double length = tree.distance(joint, jointOf(bones, above));
    const std::vector<JointIndex>& siblings = tree.children(tree.parent(joint));
    const bool shared = std::any_of(siblings.begin(), siblings.end(), [&](JointIndex other) {
      return other != joint && tree.distance(other, joint) < kSamePlace * length;
    });
    if (shared) ends.push_back(end);
  }
  if (!ends.empty()) doubts.push_back({ends, "several joints are at the same place"});
  std::vector<HumanBone> fingers;
  for (const HumanBone first : {kLeftThumbMetacarpal, kRightThumbMetacarpal}) {
    for (int i = 0; i < 15; ++i) {
      const auto bone = static_cast<HumanBone>(static_cast<int>(first) + i);
      if (jointOf(bones, bone) != kNoJoint) fingers.push_back(bone);
    }
  }
  if (!fingers.empty()) doubts.push_back({fingers, "fingers are told apart by their places alone"});
}

/// Adds missing bones of a skeleton with known hips and legs by its shape: trunk, neck, head, collar bones, feet, toes,
/// hands and fingers.
void addBonesByShape(const JointTree& tree, std::span<const JointName> names, BoneJoints& bones) {
  const JointIndex hips = jointOf(bones, kHips);
  const JointIndex leftLeg = jointOf(bones, kLeftUpperLeg);
  const JointIndex rightLeg = jointOf(bones, kRightUpperLeg);
  if (hips == kNoJoint || leftLeg == kNoJoint || rightLeg == kNoJoint) return;
  const Reach reach(tree);

  JointIndex chest = topOfTrunk(tree, bones);
  if (chest == kNoJoint) chest = hips;
  Vec3 up = trunkAxis(tree, bones, 0.5 * (tree.position(leftLeg) + tree.position(rightLeg)));
  const double trunkLength = up.norm();
  if (!(trunkLength > 0.0)) return;
  up /= trunkLength;

  if (jointOf(bones, kHead) == kNoJoint) {
    const JointIndex neck = jointOf(bones, kNeck);
    const JointIndex from = neck != kNoJoint ? neck : chest;
    JointIndex first = findHead(tree, reach, names, from, up, bones);
    // Where the arms hang on two joints of the trunk, the head may be above the upper one.
    for (const HumanBone arm : {kLeftUpperArm, kRightUpperArm}) {
      if (!tree.isBelow(jointOf(bones, arm), from)) continue;
      for (const JointIndex joint : tree.pathBelow(from, jointOf(bones, arm))) {
        if (first == kNoJoint && joint != jointOf(bones, arm)) first = findHead(tree, reach, names, joint, up, bones);
      }
    }
    if (first != kNoJoint && neck != kNoJoint) jointOf(bones, kHead) = first;
    if (first != kNoJoint && neck == kNoJoint) writeHead(tree, first, up, trunkLength, bones);
  }
  if (jointOf(bones, kNeck) == kNoJoint && jointOf(bones, kHead) != kNoJoint) {
    const auto carriesArm = [&](JointIndex joint) {
      return tree.isBelow(jointOf(bones, kLeftUpperArm), joint) || tree.isBelow(jointOf(bones, kRightUpperArm), joint);
    };
    for (const JointIndex joint : tree.pathBelow(chest, jointOf(bones, kHead))) {
      if (isUsed(bones, joint)) break;
      if (isHelper(names[joint]) || carriesArm(joint)) continue;
      jointOf(bones, kNeck) = joint;
      break;
    }
  }
  const bool noTrunk = jointOf(bones, kSpine) == kNoJoint && jointOf(bones, kChest) == kNoJoint &&
                       jointOf(bones, kUpperChest) == kNoJoint;
  if (noTrunk) assignTrunk(trunkJoints(tree, names, bones), bones);

  for (const bool left : {true, false}) {
    const auto at = [&](HumanBone bone) -> JointIndex& { return jointOf(bones, onSide(bone, left)); };
    // Adds the next joint along a limb if its distance is plausible.
    const auto follow = [&](HumanBone from, HumanBone last, HumanBone to, double min) {
      if (at(from) == kNoJoint || at(last) == kNoJoint || at(to) != kNoJoint) return;
      const double above = tree.distance(at(last), at(from));
      for (const JointIndex joint : reach.wayDown(at(last))) {
        if (joint == at(last) || tree.distance(joint, at(last)) < min * above || isHelper(names[joint])) continue;
        if (!isUsed(bones, joint)) at(to) = joint;
        return;
      }
    };
    follow(kLeftUpperLeg, kLeftLowerLeg, kLeftFoot, 0.5);
    follow(kLeftLowerLeg, kLeftFoot, kLeftToes, 0.05);
    follow(kLeftUpperArm, kLeftLowerArm, kLeftHand, 0.5);
    const JointIndex arm = at(kLeftUpperArm);
    if (arm != kNoJoint && at(kLeftShoulder) == kNoJoint && tree.isBelow(arm, chest)) {
      writeShoulder(tree, chest, onSide(kLeftShoulder, left), arm, names, bones);
    }
    bool hasFingers = false;
    for (int bone = static_cast<int>(kLeftThumbMetacarpal); bone <= static_cast<int>(kLeftLittleDistal); ++bone) {
      hasFingers = hasFingers || at(static_cast<HumanBone>(bone)) != kNoJoint;
    }
    if (!hasFingers) addFingersByShape(tree, reach, left, bones);
  }
}

/// Finds the bones only by the shape of the skeleton in its rest pose: two similar limbs that point away from the trunk
/// are legs, two similar limbs at its other end are arms, with a head between them, see findBody(). The skeleton may
/// have any orientation. Left is determined by side words in the names, else by the toes, else by the knees, else it is
/// at +X.
[[nodiscard]] ShapedBones bonesByShape(const JointTree& tree, std::span<const JointName> names) {
  ShapedBones shaped;
  BoneJoints& bones = shaped.jointOf;
  bones.fill(kNoJoint);
  std::optional<BodyShape> body = findBody(tree, Reach(tree), names);
  if (!body) return shaped;
  jointOf(bones, kHips) = body->hips;
  for (const bool left : {true, false}) {
    const Limb& leg = body->leg[left == body->leftLegFirst ? 0 : 1];
    jointOf(bones, onSide(kLeftUpperLeg, left)) = leg.upper;
    jointOf(bones, onSide(kLeftLowerLeg, left)) = leg.lower;
    jointOf(bones, onSide(kLeftFoot, left)) = leg.end;
    jointOf(bones, onSide(kLeftToes, left)) = leg.beyond;
    const Limb& arm = body->arm[left == body->leftArmFirst ? 0 : 1];
    jointOf(bones, onSide(kLeftUpperArm, left)) = arm.upper;
    jointOf(bones, onSide(kLeftLowerArm, left)) = arm.lower;
    jointOf(bones, onSide(kLeftHand, left)) = arm.end;
  }
  addBonesByShape(tree, names, bones);
  shaped.doubts = std::move(body->doubts);
  addEndDoubts(tree, bones, shaped.doubts);
  return shaped;
}

/// Replaces a puppet's thigh that only leads sideways from the middle to the leg by the next joint. Rotated like a
/// thigh, it would fold the leg under the body.
void dropSidewaysThighs(const JointTree& tree, BoneJoints& bones) {
  const JointIndex hips = jointOf(bones, kHips);
  std::array<Vec3, 2> thighs;
  Vec3 legTop = Vec3::Zero();
  for (const bool left : {true, false}) {
    const JointIndex upper = jointOf(bones, onSide(kLeftUpperLeg, left));
    const JointIndex lower = jointOf(bones, onSide(kLeftLowerLeg, left));
    if (hips == kNoJoint || upper == kNoJoint || lower == kNoJoint) return;
    thighs[left ? 0 : 1] = tree.position(lower) - tree.position(upper);
    legTop += 0.5 * tree.position(upper);
  }
  const Vec3 up = trunkAxis(tree, bones, legTop).normalized();
  const Vec3 left = thighs[0].normalized();
  const Vec3 right = thighs[1].normalized();
  if (left.dot(right) > -0.5 || std::abs(left.dot(up)) > 0.4 || std::abs(right.dot(up)) > 0.4) return;
  for (const bool side : {true, false}) {
    jointOf(bones, onSide(kLeftUpperLeg, side)) = jointOf(bones, onSide(kLeftLowerLeg, side));
    jointOf(bones, onSide(kLeftLowerLeg, side)) = kNoJoint;
  }
}

/// Whether arms and legs point the same way, across the trunk: an animal, whatever the names of its joints.
[[nodiscard]] bool isFourLegged(const JointTree& tree, const BoneJoints& bones) {
  const auto middle = [&](HumanBone left) { return middleOf(tree, bones, left); };
  const std::optional<Vec3> legTop = middle(kLeftUpperLeg);
  const std::optional<Vec3> legEnd = middle(kLeftFoot) ? middle(kLeftFoot) : middle(kLeftLowerLeg);
  const std::optional<Vec3> armTop = middle(kLeftUpperArm);
  const std::optional<Vec3> armEnd = middle(kLeftHand) ? middle(kLeftHand) : middle(kLeftLowerArm);
  if (!legTop || !legEnd || !armTop || !armEnd) return false;
  const Vec3 trunk = (*armTop - *legTop).normalized();
  const Vec3 legs = (*legEnd - *legTop).normalized();
  const Vec3 arms = (*armEnd - *armTop).normalized();
  return std::abs(trunk.dot(legs)) < 0.7 && std::abs(trunk.dot(arms)) < 0.7 && legs.dot(arms) > 0.7;
}

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

/// Removes guessed bones that contradict those that were given, or the hierarchy: their joint is another bone's, or not
/// below the joint of the parent bone.
void dropStrayBones(const JointTree& tree, const BoneJoints& given, BoneJoints& bones) {
  BoneJoints kept = given;
  for (std::size_t bone = 0; bone < bones.size(); ++bone) {
    if (kept[bone] == kNoJoint && !isUsed(kept, bones[bone])) kept[bone] = bones[bone];
  }
  bones = kept;
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
