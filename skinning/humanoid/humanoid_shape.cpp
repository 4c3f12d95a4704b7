#include "skinning/humanoid/humanoid_shape.h"

#include "skinning/humanoid/humanoid_body.h"
#include "skinning/humanoid/humanoid_names.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace lorica {

namespace {

using enum HumanBone;

void writeHead(const JointTree& tree, JointIndex first, const Vec3& up, double trunkLength, BoneJoints& bones) {
  // The chain up to the joint where face and hair branch off.
  std::vector<JointIndex> way = {first};
  while (tree.children(way.back()).size() == 1 && way.size() < 6) way.push_back(tree.children(way.back()).front());
  const bool isLeaf = tree.children(way.back()).empty();
  const auto segment = [&](std::size_t i) { return (tree.position(way[i]) - tree.position(way[i - 1])).norm(); };
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
  const double armLength = std::max(1e-9, (tree.position(upperArm) - tree.position(chest)).norm());
  for (const JointIndex joint : tree.pathBelow(chest, upperArm)) {
    if (joint == upperArm) return;
    const bool apart = (tree.position(joint) - tree.position(upperArm)).norm() > 0.05 * armLength;
    const bool used = std::find(bones.begin(), bones.end(), joint) != bones.end();
    const bool carriesHead = tree.isBelow(jointOf(bones, kHead), joint);
    if (!apart || used || carriesHead || isHelper(names[joint])) continue;
    jointOf(bones, shoulder) = joint;
    return;
  }
}

[[nodiscard]] HumanBone onSide(HumanBone bone, bool left) {
  return left ? bone : mirrored(bone);
}

/// From between the thighs to between the arms; without arms to the head; else opposite to the legs [m].
[[nodiscard]] Vec3 trunkAxis(const JointTree& tree, const BoneJoints& bones, const Vec3& legTop) {
  const auto both = [&](HumanBone left) {
    return jointOf(bones, left) != kNoJoint && jointOf(bones, mirrored(left)) != kNoJoint;
  };
  const auto middle = [&](HumanBone left) -> Vec3 {
    return 0.5 * (tree.position(jointOf(bones, left)) + tree.position(jointOf(bones, mirrored(left))));
  };
  if (both(kLeftUpperArm)) return middle(kLeftUpperArm) - legTop;
  if (jointOf(bones, kHead) != kNoJoint) return tree.position(jointOf(bones, kHead)) - legTop;
  if (both(kLeftFoot)) return legTop - middle(kLeftFoot);
  return both(kLeftLowerLeg) ? Vec3(legTop - middle(kLeftLowerLeg)) : Vec3(Vec3::Zero());
}

}  // namespace

namespace {

/// Hands and feet that have a sibling at the same place, and fingers, whose order depends on how the hand is held.
void addEndDoubts(const JointTree& tree, const BoneJoints& bones, std::vector<BoneDoubt>& doubts) {
  constexpr double kSamePlace = 0.01;  // of the bone above
  std::vector<HumanBone> ends;
  for (const auto& [end, above] : {std::pair(kLeftHand, kLeftLowerArm), std::pair(kRightHand, kRightLowerArm),
                                   std::pair(kLeftFoot, kLeftLowerLeg), std::pair(kRightFoot, kRightLowerLeg)}) {
    const JointIndex joint = jointOf(bones, end);
    if (joint == kNoJoint) continue;
    const Vec3& place = tree.position(joint);
    const double length = (place - tree.position(jointOf(bones, above))).norm();
    const std::vector<JointIndex>& siblings = tree.children(tree.parent(joint));
    const bool shared = std::any_of(siblings.begin(), siblings.end(), [&](JointIndex other) {
      return other != joint && (tree.position(other) - place).norm() < kSamePlace * length;
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

}  // namespace

ShapedBones bonesByShape(const JointTree& tree, std::span<const JointName> names) {
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

void addBonesByShape(const JointTree& tree, std::span<const JointName> names, BoneJoints& bones) {
  const JointIndex hips = jointOf(bones, kHips);
  const JointIndex leftLeg = jointOf(bones, kLeftUpperLeg);
  const JointIndex rightLeg = jointOf(bones, kRightUpperLeg);
  if (hips == kNoJoint || leftLeg == kNoJoint || rightLeg == kNoJoint) return;
  const Reach reach(tree);
  const auto isUsed = [&](JointIndex joint) { return std::find(bones.begin(), bones.end(), joint) != bones.end(); };

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
      if (isUsed(joint)) break;
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
      const double above = (tree.position(at(last)) - tree.position(at(from))).norm();
      for (const JointIndex joint : reach.wayDown(at(last))) {
        const double beyond = (tree.position(joint) - tree.position(at(last))).norm();
        if (joint == at(last) || beyond < min * above || isHelper(names[joint])) continue;
        if (!isUsed(joint)) at(to) = joint;
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

bool isFourLegged(const JointTree& tree, const BoneJoints& bones) {
  const auto middle = [&](HumanBone left) -> std::optional<Vec3> {
    const JointIndex a = jointOf(bones, left);
    const JointIndex b = jointOf(bones, mirrored(left));
    if (a == kNoJoint || b == kNoJoint) return std::nullopt;
    return 0.5 * (tree.position(a) + tree.position(b));
  };
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

}  // namespace lorica
