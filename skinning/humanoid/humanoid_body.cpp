#include "skinning/humanoid/humanoid_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

constexpr std::size_t kMaxPairs = 12;
constexpr std::size_t kMaxDeepPairs = 40;  ///< pairs that are compared joint by joint
constexpr std::size_t kMaxOfLimb = 32;     ///< joints of a limb that are compared
constexpr double kInCommon = 0.5;          ///< of the shorter limb, at least, is common to matched limbs

void keepLongest(std::vector<LimbPair>& pairs, std::size_t count) {
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const LimbPair& a, const LimbPair& b) { return a.length > b.length; });
  if (pairs.size() > count) pairs.resize(count);
}

/// The joint itself and those below it, parents before children.
[[nodiscard]] std::vector<JointIndex> limbJoints(const JointTree& tree, JointIndex top) {
  std::vector<JointIndex> joints = {top};
  for (std::size_t i = 0; i < joints.size() && joints.size() < kMaxOfLimb; ++i) {
    const std::vector<JointIndex>& children = tree.children(joints[i]);
    joints.insert(joints.end(), children.begin(), children.end());
  }
  if (joints.size() > kMaxOfLimb) joints.resize(kMaxOfLimb);
  return joints;
}

/// The longest way down that two limbs have in common, written to the pair: dynamic programming over pairs of joints.
void match(const JointTree& tree, LimbPair& pair) {
  constexpr double kAlike = 0.88;       // of two distances that count as equal
  constexpr double kMoreJoints = 1e-3;  // of ways of equal length the one with more joints
  const std::vector<JointIndex> a = limbJoints(tree, pair.tops[0]);
  const std::vector<JointIndex> b = limbJoints(tree, pair.tops[1]);
  struct Best {
    double length = 0.0, score = 0.0;
    std::size_t nextA = 0, nextB = 0;  // 0: the way ends
  };
  std::vector<Best> best(a.size() * b.size());
  for (std::size_t i = a.size(); i-- > 0;) {
    for (std::size_t j = b.size(); j-- > 0;) {
      Best& here = best[i * b.size() + j];
      for (std::size_t k = i + 1; k < a.size(); ++k) {
        if (!tree.isBelow(a[k], a[i])) continue;
        const double down = tree.distance(a[i], a[k]);
        for (std::size_t l = j + 1; l < b.size(); ++l) {
          if (!tree.isBelow(b[l], b[j])) continue;
          const double other = tree.distance(b[j], b[l]);
          const double shorter = std::min(down, other);
          if (shorter < kAlike * std::max(down, other) || shorter <= 0.0) continue;
          const Best& after = best[k * b.size() + l];
          const double score = (1.0 + kMoreJoints) * shorter + after.score;
          // Rounding must not decide between ways that are equally long.
          if (score <= here.score * (1.0 + 1e-9)) continue;
          here = {shorter + after.length, score, k, l};
        }
      }
    }
  }
  pair.length = best.front().length;
  pair.ways = {std::vector<JointIndex>{a[0]}, std::vector<JointIndex>{b[0]}};
  for (const Best* at = &best.front(); at->nextA != 0; at = &best[at->nextA * b.size() + at->nextB]) {
    pair.ways[0].push_back(a[at->nextA]);
    pair.ways[1].push_back(b[at->nextB]);
  }
  pair.matched = true;
}

/// Limbs that hang on one joint, or on two of which one carries the other, without being part of each other.
[[nodiscard]] std::vector<LimbPair> pairsOfTrunk(const JointTree& tree, const Reach& reach) {
  constexpr std::size_t kMaxTops = 200;  // bounds the work for skeletons of thousands of joints
  std::vector<JointIndex> tops;
  for (JointIndex joint = 0; joint < tree.jointCount(); ++joint) {
    if (reach.length[joint] > 0.0 && tree.parent(joint) != kNoJoint) tops.push_back(joint);
  }
  std::stable_sort(tops.begin(), tops.end(),
                   [&](JointIndex a, JointIndex b) { return reach.length[a] > reach.length[b]; });
  if (tops.size() > kMaxTops) tops.resize(kMaxTops);
  std::sort(tops.begin(), tops.end());
  std::vector<LimbPair> pairs;
  for (std::size_t i = 0; i < tops.size(); ++i) {
    for (std::size_t j = i + 1; j < tops.size(); ++j) {
      const JointIndex a = tops[i];
      const JointIndex b = tops[j];
      if (tree.isBelow(a, b) || tree.isBelow(b, a)) continue;
      const JointIndex aboveA = tree.parent(a);
      const JointIndex aboveB = tree.parent(b);
      if (!tree.isBelowOrSame(aboveA, aboveB) && !tree.isBelowOrSame(aboveB, aboveA)) continue;
      const double length = std::min(reach.length[a], reach.length[b]);
      pairs.push_back({tree.commonAncestor(a, b), {a, b}, {}, length, false});
    }
  }
  keepLongest(pairs, kMaxDeepPairs);
  return pairs;
}

/// Pairs of limbs on one joint whose longest paths have about the same length and number of joints, in descending
/// length.
[[nodiscard]] std::vector<LimbPair> regularPairs(const JointTree& tree, const Reach& reach) {
  constexpr std::size_t kMaxChildren = 8;
  std::vector<LimbPair> pairs;
  for (JointIndex branch = 0; branch < tree.jointCount(); ++branch) {
    std::vector<JointIndex> children = tree.children(branch);
    const auto whole = [&](JointIndex child) { return reach.length[child] + tree.distance(child, branch); };
    std::erase_if(children, [&](JointIndex child) { return reach.size[child] < 2; });
    std::stable_sort(children.begin(), children.end(), [&](JointIndex a, JointIndex b) { return whole(a) > whole(b); });
    if (children.size() > kMaxChildren) children.resize(kMaxChildren);
    for (std::size_t i = 0; i < children.size(); ++i) {
      for (std::size_t j = i + 1; j < children.size(); ++j) {
        const double longer = whole(children[i]);
        const double shorter = whole(children[j]);
        const int more = std::max(reach.size[children[i]], reach.size[children[j]]);
        const int fewer = std::min(reach.size[children[i]], reach.size[children[j]]);
        if (shorter < 0.75 * longer || fewer * 10 < more * 6) continue;
        pairs.push_back({branch,
                         {children[i], children[j]},
                         {reach.wayDown(children[i]), reach.wayDown(children[j])},
                         shorter,
                         false});
      }
    }
  }
  keepLongest(pairs, kMaxPairs);
  return pairs;
}

/// Pairs of limbs on one joint or along one trunk that have a way down in common: the same distances from joint to
/// joint, whatever else hangs on either of them, such as a tool in one hand. In descending length.
[[nodiscard]] std::vector<LimbPair> matchedPairs(const JointTree& tree, const Reach& reach) {
  std::vector<LimbPair> pairs = pairsOfTrunk(tree, reach);
  for (LimbPair& pair : pairs) match(tree, pair);
  std::erase_if(pairs, [&](const LimbPair& pair) {
    const double shorter = std::min(reach.length[pair.tops[0]], reach.length[pair.tops[1]]);
    return pair.ways[0].size() < 2 || pair.length < kInCommon * shorter;
  });
  keepLongest(pairs, kMaxPairs);
  return pairs;
}

/// Pairs of limbs that start where those of the other side would, but are not alike: one arm is a tool.
/// @param legs  define the plane between left and right
[[nodiscard]] std::vector<LimbPair> lopsidedPairs(const JointTree& tree, const Reach& reach, const LimbPair& legs) {
  constexpr double kNearMirror = 0.1;  // of the legs' length
  const Vec3 middle = 0.5 * (tree.position(legs.tops[0]) + tree.position(legs.tops[1]));
  const Vec3 apart = tree.position(legs.tops[0]) - tree.position(legs.tops[1]);
  if (!(apart.norm() > 0.02 * legs.length)) return {};
  const Vec3 across = apart.normalized();
  std::vector<LimbPair> pairs;
  for (LimbPair& pair : pairsOfTrunk(tree, reach)) {
    const auto legOf = [&](JointIndex top) {
      return tree.isBelowOrSame(top, legs.tops[0]) || tree.isBelowOrSame(top, legs.tops[1]);
    };
    if (legOf(pair.tops[0]) || legOf(pair.tops[1])) continue;
    const Vec3& a = tree.position(pair.tops[0]);
    const Vec3& b = tree.position(pair.tops[1]);
    const Vec3 mirrored = a - 2.0 * across.dot(a - middle) * across;
    if ((mirrored - b).norm() > kNearMirror * legs.length) continue;
    // What they have in common is above the arm: a collar bone.
    match(tree, pair);
    pair.ways = {reach.wayDown(pair.ways[0].back()), reach.wayDown(pair.ways[1].back())};
    pair.matched = false;
    pair.length = std::min(reach.length[pair.tops[0]], reach.length[pair.tops[1]]);
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

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
      lengths[i] = tree.distance(limbs[i].*to, limbs[i].*from);
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
