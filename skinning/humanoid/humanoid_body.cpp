#include "skinning/humanoid/humanoid_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lorica {

JointIndex findHead(const JointTree& tree, const Reach& reach, std::span<const JointName> names, JointIndex chest,
                    const Vec3& up, std::span<const JointIndex> taken) {
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

namespace {

using enum HumanBone;

[[nodiscard]] Vec3 farEnd(const JointTree& tree, const Limb& limb) {
  return tree.position(limb.end != kNoJoint ? limb.end : limb.lower);
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

/// The limbs of a pair. Matched limbs are split at the same joints.
[[nodiscard]] std::array<Limb, 2> splitPair(const JointTree& tree, const LimbPair& pair, LimbKind kind) {
  std::array<Limb, 2> limbs = {splitLimb(tree, pair.ways[0], kind), Limb{}};
  if (!pair.matched) {
    limbs[1] = splitLimb(tree, pair.ways[1], kind);
    return limbs;
  }
  for (JointIndex Limb::*const joint : {&Limb::upper, &Limb::lower, &Limb::end, &Limb::beyond}) {
    const auto at = std::find(pair.ways[0].begin(), pair.ways[0].end(), limbs[0].*joint);
    if (at != pair.ways[0].end()) limbs[1].*joint = pair.ways[1][at - pair.ways[0].begin()];
  }
  return limbs;
}

/// The body with these pairs as legs and arms; none if they do not fit a human.
/// @param lopsided  the arms need not be alike
[[nodiscard]] std::optional<BodyShape> tryBody(const JointTree& tree, const Reach& reach,
                                               std::span<const JointName> names, const LimbPair& legs,
                                               const LimbPair& arms, bool lopsided) {
  for (const JointIndex top : legs.tops) {
    if (tree.isBelowOrSame(arms.branch, top)) return std::nullopt;
  }
  for (const JointIndex top : arms.tops) {
    if (tree.isBelowOrSame(legs.branch, top)) return std::nullopt;
  }
  // Four limbs on one joint are not a human's.
  if (legs.branch == arms.branch) return std::nullopt;
  BodyShape body{legs,     arms,         {},   {},   tree.commonAncestor(legs.branch, arms.branch),
                 kNoJoint, Vec3::Zero(), true, true, {}};
  if (body.hips == kNoJoint || body.hips == arms.branch) return std::nullopt;
  body.leg = splitPair(tree, legs, LimbKind::kLeg);
  body.arm = splitPair(tree, arms, LimbKind::kArm);
  for (const Limb& limb : {body.leg[0], body.leg[1], body.arm[0], body.arm[1]}) {
    if (limb.lower == kNoJoint) return std::nullopt;
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
  if (!legs.matched && !areAlike(tree, body.leg)) return std::nullopt;
  if (!lopsided && !arms.matched && !areAlike(tree, body.arm)) return std::nullopt;
  const std::array<JointIndex, 4> taken = {legs.tops[0], legs.tops[1], arms.tops[0], arms.tops[1]};
  // Arms may hang on two joints of the trunk; the head is above either.
  for (const JointIndex chest : {arms.branch, tree.parent(arms.tops[0]), tree.parent(arms.tops[1])}) {
    if (body.head == kNoJoint) body.head = findHead(tree, reach, names, chest, body.up, taken);
  }
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

/// Whether a limb ends in several fingers.
[[nodiscard]] bool hasHand(const JointTree& tree, const Reach& reach, const LimbPair& pair) {
  const auto isHand = [&](JointIndex joint) {
    const std::vector<JointIndex>& children = tree.children(joint);
    return std::count_if(children.begin(), children.end(), [&](JointIndex child) { return reach.size[child] > 1; }) > 2;
  };
  return std::all_of(pair.ways.begin(), pair.ways.end(),
                     [&](const auto& way) { return std::any_of(way.begin(), way.end(), isHand); });
}

/// How plausible a body is among others of the same skeleton: by the length of its limbs. Wings and pigtails may be
/// longer than arms, but have no hands.
[[nodiscard]] double plausibility(const JointTree& tree, const Reach& reach, const BodyShape& body) {
  constexpr double kHand = 1.5;
  return body.legs.length + body.arms.length * (hasHand(tree, reach, body.arms) ? kHand : 1.0);
}

/// All bodies that have one of these pairs as legs and one as arms.
void addBodies(const JointTree& tree, const Reach& reach, std::span<const JointName> names,
               std::span<const LimbPair> legs, std::span<const LimbPair> arms, bool lopsided,
               std::vector<BodyShape>& bodies) {
  for (const LimbPair& lower : legs) {
    for (const LimbPair& upper : arms) {
      std::optional<BodyShape> body = tryBody(tree, reach, names, lower, upper, lopsided);
      if (body) bodies.push_back(std::move(*body));
    }
  }
}

/// The most plausible one; of equally plausible ones the first. Null if there is none.
[[nodiscard]] const BodyShape* bestOf(const JointTree& tree, const Reach& reach, std::span<const BodyShape> bodies) {
  const BodyShape* best = nullptr;
  double most = 0.0;
  for (const BodyShape& body : bodies) {
    const double its = plausibility(tree, reach, body);
    if (best != nullptr && its <= most) continue;
    best = &body;
    most = its;
  }
  return best;
}

/// Whether two pairs are other limbs, not other places to start on the same ones.
[[nodiscard]] bool areOthers(const JointTree& tree, const LimbPair& a, const LimbPair& b) {
  for (const JointIndex one : a.tops) {
    for (const JointIndex other : b.tops) {
      if (tree.isBelowOrSame(one, other) || tree.isBelow(other, one)) return false;
    }
  }
  return true;
}

/// Whether the limbs go on differently where their common way ends.
[[nodiscard]] bool goOnDifferently(const Reach& reach, const LimbPair& pair) {
  constexpr double kMuch = 0.35;  // of the common way
  if (!pair.matched) return false;
  const double longer = std::max(reach.length[pair.tops[0]], reach.length[pair.tops[1]]);
  return longer > (1.0 + kMuch) * pair.length;
}

void writeSides(const JointTree& tree, std::span<const JointName> names, BodyShape& body) {
  const Vec3 armsApart = tree.position(body.arm[0].upper) - tree.position(body.arm[1].upper);
  const Vec3 legsApart = tree.position(body.leg[0].upper) - tree.position(body.leg[1].upper);
  body.leftArmFirst = firstIsLeft(tree, names, body, body.arms, armsApart);
  // Thighs may start at the same position; then their far ends distinguish them.
  const Vec3 legEndsApart = farEnd(tree, body.leg[0]) - farEnd(tree, body.leg[1]);
  const bool likeArms = (legsApart.norm() > 0.02 * legEndsApart.norm() ? legsApart : legEndsApart).dot(armsApart) > 0.0;
  body.leftLegFirst = likeArms == body.leftArmFirst;
}

void writeDoubts(const JointTree& tree, const Reach& reach, std::span<const JointName> names,
                 std::span<const BodyShape> bodies, bool lopsided, BodyShape& body) {
  constexpr double kAlmostAsLong = 0.6;
  const std::vector<HumanBone> armBones = {kLeftUpperArm,  kLeftLowerArm,  kLeftHand,
                                           kRightUpperArm, kRightLowerArm, kRightHand};
  const std::vector<HumanBone> legBones = {kLeftUpperLeg,  kLeftLowerLeg,  kLeftFoot,
                                           kRightUpperLeg, kRightLowerLeg, kRightFoot};
  const bool named = sideByNames(tree, names, body.arms.tops[0]) != sideByNames(tree, names, body.arms.tops[1]);
  if (!named && facing(tree, body).isZero()) {
    body.doubts.push_back({{kLeftUpperLeg, kRightUpperLeg, kLeftUpperArm, kRightUpperArm},
                           "neither names nor feet nor knees tell left from right; the body is taken to face +Z"});
  }
  if (lopsided) {
    std::vector<HumanBone> all = armBones;
    all.insert(all.begin(), {kLeftShoulder, kRightShoulder});
    body.doubts.push_back({std::move(all), "the arms are not alike"});
  } else if (goOnDifferently(reach, body.arms)) {
    body.doubts.push_back({{kLeftLowerArm, kLeftHand, kRightLowerArm, kRightHand},
                           "one arm goes on where the other ends, as with a tool in the hand"});
  }
  if (goOnDifferently(reach, body.legs)) {
    body.doubts.push_back(
        {{kLeftLowerLeg, kLeftFoot, kRightLowerLeg, kRightFoot}, "one leg goes on where the other ends"});
  }
  bool otherArms = false;
  bool otherLegs = false;
  for (const BodyShape& other : bodies) {
    const bool arms = areOthers(tree, other.arms, body.arms);
    const bool legs = areOthers(tree, other.legs, body.legs);
    otherArms = otherArms || (arms && !legs && other.arms.length > kAlmostAsLong * body.arms.length);
    otherLegs = otherLegs || (legs && !arms && other.legs.length > kAlmostAsLong * body.legs.length);
  }
  if (otherArms) body.doubts.push_back({armBones, "another pair of limbs could be the arms"});
  if (otherLegs) body.doubts.push_back({legBones, "another pair of limbs could be the legs"});
}

}  // namespace

std::optional<BodyShape> findBody(const JointTree& tree, const Reach& reach, std::span<const JointName> names) {
  constexpr double kMatchedBetter = 1.1;   // what two limbs have in common must be longer than a pair that is alike
  constexpr double kMatchedEnough = 0.75;  // unless one of the pair has more joints, such as twist joints
  const std::vector<LimbPair> regular = regularPairs(tree, reach);
  const std::vector<LimbPair> matched = matchedPairs(tree, reach);
  std::vector<BodyShape> bodies;
  std::vector<BodyShape> matchedBodies;
  addBodies(tree, reach, names, regular, regular, false, bodies);
  addBodies(tree, reach, names, matched, matched, false, matchedBodies);
  bool lopsided = false;
  if (bodies.empty() && matchedBodies.empty()) {
    lopsided = true;
    for (const LimbPair& legs : matched) {
      addBodies(tree, reach, names, {&legs, 1}, lopsidedPairs(tree, reach, legs), true, bodies);
    }
  }
  const BodyShape* best = bestOf(tree, reach, bodies);
  const BodyShape* common = bestOf(tree, reach, matchedBodies);
  if (best == nullptr && common == nullptr) return std::nullopt;
  bool takeCommon = best == nullptr;
  if (best != nullptr && common != nullptr) {
    const bool even = best->legs.ways[0].size() == best->legs.ways[1].size() &&
                      best->arms.ways[0].size() == best->arms.ways[1].size();
    takeCommon = plausibility(tree, reach, *common) >
                 (even ? kMatchedBetter : kMatchedEnough) * plausibility(tree, reach, *best);
  }
  BodyShape body = takeCommon ? *common : *best;
  writeSides(tree, names, body);
  bodies.insert(bodies.end(), matchedBodies.begin(), matchedBodies.end());
  writeDoubts(tree, reach, names, bodies, lopsided, body);
  return body;
}

}  // namespace lorica
