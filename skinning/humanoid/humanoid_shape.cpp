#include "skinning/humanoid/humanoid_shape.h"

#include "skinning/humanoid/humanoid_limbs.h"
#include "skinning/humanoid/humanoid_names.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lorica {

namespace {

using enum HumanBone;

/// Two limbs of similar length on one joint.
struct LimbPair {
  JointIndex branch = kNoJoint;
  std::array<JointIndex, 2> tops{};
  double length = 0.0;  ///< of the shorter [m]
};

[[nodiscard]] double length(const Reach& reach, JointIndex joint) {
  return reach.length[joint];
}

[[nodiscard]] int size(const Reach& reach, JointIndex joint) {
  return reach.size[joint];
}

/// The longest pairs of a skeleton, in descending length.
[[nodiscard]] std::vector<LimbPair> findPairs(const JointTree& tree, const Reach& reach) {
  constexpr std::size_t kMaxChildren = 8;
  constexpr std::size_t kMaxPairs = 12;
  std::vector<LimbPair> pairs;
  for (JointIndex branch = 0; branch < tree.jointCount(); ++branch) {
    std::vector<JointIndex> children = tree.children(branch);
    const auto whole = [&](JointIndex child) {
      return length(reach, child) + (tree.position(child) - tree.position(branch)).norm();
    };
    std::erase_if(children, [&](JointIndex child) { return size(reach, child) < 2; });
    std::stable_sort(children.begin(), children.end(), [&](JointIndex a, JointIndex b) { return whole(a) > whole(b); });
    if (children.size() > kMaxChildren) children.resize(kMaxChildren);
    for (std::size_t i = 0; i < children.size(); ++i) {
      for (std::size_t j = i + 1; j < children.size(); ++j) {
        const double longer = whole(children[i]);
        const double shorter = whole(children[j]);
        const int more = std::max(size(reach, children[i]), size(reach, children[j]));
        const int fewer = std::min(size(reach, children[i]), size(reach, children[j]));
        if (shorter < 0.75 * longer || fewer * 10 < more * 6) continue;
        pairs.push_back({branch, {children[i], children[j]}, shorter});
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const LimbPair& a, const LimbPair& b) { return a.length > b.length; });
  if (pairs.size() > kMaxPairs) pairs.resize(kMaxPairs);
  return pairs;
}

/// Legs and arms of a skeleton, and its up direction.
struct BodyShape {
  LimbPair legs;
  LimbPair arms;
  std::array<Limb, 2> leg;
  std::array<Limb, 2> arm;
  JointIndex hips = kNoJoint;
  JointIndex head = kNoJoint;  ///< first joint of the path to the head
  Vec3 up = Vec3::Zero();
};

[[nodiscard]] Vec3 farEnd(const JointTree& tree, const Limb& limb) {
  return tree.position(limb.end != kNoJoint ? limb.end : limb.lower);
}

/// The child of the chest that leads up and carries neither an arm nor a leg.
[[nodiscard]] JointIndex findHead(const JointTree& tree, const Reach& reach, std::span<const JointName> names,
                                  JointIndex chest, const Vec3& up, std::span<const JointIndex> taken) {
  JointIndex best = kNoJoint;
  double highest = 0.0;
  for (const JointIndex child : tree.children(chest)) {
    const bool isTaken = std::any_of(taken.begin(), taken.end(), [&](JointIndex joint) {
      return joint != kNoJoint && (tree.isBelowOrSame(joint, child));
    });
    if (isTaken || isHelper(names[child])) continue;
    for (const JointIndex joint : reach.wayDown(child)) {
      const Vec3 way = tree.position(joint) - tree.position(chest);
      const double height = way.dot(up);
      if (height < 0.6 * way.norm() || height <= highest * (1.0 + 1e-6)) continue;
      highest = height;
      best = child;
    }
  }
  return best;
}

/// Whether the limbs of a pair have segments of similar length.
[[nodiscard]] bool areAlike(const JointTree& tree, const std::array<Limb, 2>& limbs) {
  const auto alike = [&](JointIndex Limb::*from, JointIndex Limb::*to) {
    std::array<double, 2> lengths{};
    for (std::size_t i = 0; i < 2; ++i) {
      if ((limbs[0].*to == kNoJoint) != (limbs[1].*to == kNoJoint)) return false;
      if (limbs[i].*to == kNoJoint) return true;
      lengths[i] = (tree.position(limbs[i].*to) - tree.position(limbs[i].*from)).norm();
    }
    return std::min(lengths[0], lengths[1]) > 0.7 * std::max(lengths[0], lengths[1]);
  };
  return alike(&Limb::upper, &Limb::lower) && alike(&Limb::lower, &Limb::end);
}

/// The body with these pairs as legs and arms; none if they do not fit a human.
[[nodiscard]] std::optional<BodyShape> tryBody(const JointTree& tree, const Reach& reach,
                                               std::span<const JointName> names, const LimbPair& legs,
                                               const LimbPair& arms) {
  for (const JointIndex top : legs.tops) {
    if (tree.isBelowOrSame(arms.branch, top)) return std::nullopt;
  }
  for (const JointIndex top : arms.tops) {
    if (tree.isBelowOrSame(legs.branch, top)) return std::nullopt;
  }
  // Four limbs on one joint are not a human's.
  if (legs.branch == arms.branch) return std::nullopt;
  BodyShape body{legs, arms, {}, {}, tree.commonAncestor(legs.branch, arms.branch), kNoJoint, Vec3::Zero()};
  if (body.hips == kNoJoint || body.hips == arms.branch) return std::nullopt;
  for (std::size_t side = 0; side < 2; ++side) {
    body.leg[side] = splitLimb(tree, reach.wayDown(legs.tops[side]), LimbKind::kLeg);
    body.arm[side] = splitLimb(tree, reach.wayDown(arms.tops[side]), LimbKind::kArm);
    if (body.leg[side].lower == kNoJoint || body.arm[side].lower == kNoJoint) return std::nullopt;
  }

  const Vec3 legTop = 0.5 * (tree.position(body.leg[0].upper) + tree.position(body.leg[1].upper));
  const Vec3 armTop = 0.5 * (tree.position(body.arm[0].upper) + tree.position(body.arm[1].upper));
  const Vec3 legEnd = 0.5 * (farEnd(tree, body.leg[0]) + farEnd(tree, body.leg[1]));
  body.up = armTop - legTop;
  const Vec3 down = legEnd - legTop;
  if (body.up.norm() < 0.2 * down.norm() || down.norm() < 0.3 * body.up.norm()) return std::nullopt;
  body.up.normalize();
  if (body.up.dot(down.normalized()) > -0.5) return std::nullopt;

  // Both pairs are spread to the same two sides, across the trunk, and the limbs of a pair mirror each other.
  const Vec3 legsApart = tree.position(body.leg[0].upper) - tree.position(body.leg[1].upper);
  const Vec3 armsApart = tree.position(body.arm[0].upper) - tree.position(body.arm[1].upper);
  const Vec3 across = armsApart.normalized();
  if (std::abs(across.dot(body.up)) > 0.3) return std::nullopt;
  if (std::abs(across.dot(armTop - legTop)) > 0.2 * (armTop - legTop).norm()) return std::nullopt;
  if (legsApart.norm() > 0.02 * down.norm() && std::abs(legsApart.normalized().dot(across)) < 0.9) return std::nullopt;
  if (!areAlike(tree, body.leg) || !areAlike(tree, body.arm)) return std::nullopt;
  const std::array<JointIndex, 4> taken = {legs.tops[0], legs.tops[1], arms.tops[0], arms.tops[1]};
  body.head = findHead(tree, reach, names, arms.branch, body.up, taken);
  if (body.head == kNoJoint) return std::nullopt;
  return body;
}

/// Joints of a limb that are named left, minus those named right; 0 if the names give no side.
[[nodiscard]] int sideByNames(const JointTree& tree, std::span<const JointName> names, JointIndex top) {
  int left = 0;
  for (JointIndex joint = top; joint < tree.jointCount(); ++joint) {
    if (!tree.isBelowOrSame(joint, top)) continue;
    const Side side = names[joint].side;
    if (side != Side::kMiddle) left += side == Side::kLeft ? 1 : -1;
  }
  return left;
}

/// Facing direction, across the trunk: where the toes point, else where the knees protrude; else zero.
[[nodiscard]] Vec3 facing(const JointTree& tree, const BodyShape& body) {
  const auto level = [&](const Vec3& v) -> Vec3 { return v - v.dot(body.up) * body.up; };
  Vec3 toes = Vec3::Zero();
  Vec3 knees = Vec3::Zero();
  double legLength = 0.0;
  for (const Limb& leg : body.leg) {
    if (leg.end == kNoJoint) continue;
    const Vec3& hip = tree.position(leg.upper);
    const Vec3 shank = tree.position(leg.end) - hip;
    const Vec3 knee = tree.position(leg.lower) - hip;
    legLength += shank.norm();
    knees += level(knee - knee.dot(shank) / std::max(shank.squaredNorm(), 1e-300) * shank);
    if (leg.beyond != kNoJoint) toes += level(tree.position(leg.beyond) - tree.position(leg.end));
  }
  // Splayed toes and bow legs cancel over both sides; the remainder must exceed small modelling errors.
  if (toes.norm() > 0.05 * legLength) return toes;
  if (knees.norm() > 0.005 * legLength) return knees;
  return Vec3::Zero();
}

/// Whether the first limb of a pair is the left one.
[[nodiscard]] bool firstIsLeft(const JointTree& tree, std::span<const JointName> names, const BodyShape& body,
                               const LimbPair& pair, const Vec3& apart) {
  const int byNames = sideByNames(tree, names, pair.tops[0]) - sideByNames(tree, names, pair.tops[1]);
  if (byNames != 0) return byNames > 0;
  Vec3 forward = facing(tree, body);
  if (forward.isZero()) forward = Vec3::UnitZ();
  Vec3 left = body.up.cross(forward);
  if (std::abs(left.dot(apart)) < 0.1 * left.norm() * apart.norm()) left = Vec3::UnitX();
  return apart.dot(left) > 0.0;
}

void writeHead(const JointTree& tree, const Reach& reach, JointIndex first, double trunkLength, BoneJoints& bones) {
  // The chain up to the joint where face and hair branch off.
  std::vector<JointIndex> way = {first};
  while (tree.children(way.back()).size() == 1 && way.size() < 6) way.push_back(tree.children(way.back()).front());
  const bool isLeaf = tree.children(way.back()).empty();
  const auto segment = [&](std::size_t i) { return (tree.position(way[i]) - tree.position(way[i - 1])).norm(); };
  // The last joint of an unbranched chain may be the top of the head: a head is longer than a neck.
  if (isLeaf && way.size() == 2 && segment(1) > 0.3 * trunkLength) way.pop_back();
  if (isLeaf && way.size() > 2 && segment(way.size() - 1) > 1.5 * segment(way.size() - 2)) way.pop_back();
  static_cast<void>(reach);
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
    if (!apart || used || isHelper(names[joint])) continue;
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

BoneJoints bonesByShape(const JointTree& tree, std::span<const JointName> names) {
  BoneJoints bones;
  bones.fill(kNoJoint);
  const Reach reach(tree);
  const std::vector<LimbPair> pairs = findPairs(tree, reach);
  std::optional<BodyShape> body;
  double best = 0.0;
  for (const LimbPair& legs : pairs) {
    for (const LimbPair& arms : pairs) {
      if (legs.length + arms.length <= best) continue;
      const std::optional<BodyShape> tried = tryBody(tree, reach, names, legs, arms);
      if (!tried) continue;
      best = legs.length + arms.length;
      body = tried;
    }
  }
  if (!body) return bones;

  jointOf(bones, kHips) = body->hips;
  const Vec3 armsApart = tree.position(body->arm[0].upper) - tree.position(body->arm[1].upper);
  const Vec3 legsApart = tree.position(body->leg[0].upper) - tree.position(body->leg[1].upper);
  const bool leftArmFirst = firstIsLeft(tree, names, *body, body->arms, armsApart);
  // Thighs may start at the same position; then their far ends distinguish them.
  const Vec3 legEndsApart = farEnd(tree, body->leg[0]) - farEnd(tree, body->leg[1]);
  const bool likeArms = (legsApart.norm() > 0.02 * legEndsApart.norm() ? legsApart : legEndsApart).dot(armsApart) > 0.0;
  const bool leftLegFirst = likeArms == leftArmFirst;
  for (const bool left : {true, false}) {
    const Limb& leg = body->leg[left == leftLegFirst ? 0 : 1];
    jointOf(bones, onSide(kLeftUpperLeg, left)) = leg.upper;
    jointOf(bones, onSide(kLeftLowerLeg, left)) = leg.lower;
    jointOf(bones, onSide(kLeftFoot, left)) = leg.end;
    jointOf(bones, onSide(kLeftToes, left)) = leg.beyond;
    const Limb& arm = body->arm[left == leftArmFirst ? 0 : 1];
    jointOf(bones, onSide(kLeftUpperArm, left)) = arm.upper;
    jointOf(bones, onSide(kLeftLowerArm, left)) = arm.lower;
    jointOf(bones, onSide(kLeftHand, left)) = arm.end;
  }
  addBonesByShape(tree, names, bones);
  return bones;
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
    const JointIndex first = findHead(tree, reach, names, from, up, bones);
    if (first != kNoJoint && neck != kNoJoint) jointOf(bones, kHead) = first;
    if (first != kNoJoint && neck == kNoJoint) writeHead(tree, reach, first, trunkLength, bones);
  }
  if (jointOf(bones, kNeck) == kNoJoint && jointOf(bones, kHead) != kNoJoint) {
    for (const JointIndex joint : tree.pathBelow(chest, jointOf(bones, kHead))) {
      if (isUsed(joint)) break;
      if (isHelper(names[joint])) continue;
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
