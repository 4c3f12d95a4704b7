#include "skinning/humanoid/humanoid_pairs.h"

#include <algorithm>
#include <utility>

namespace lorica {

namespace {

constexpr std::size_t kMaxPairs = 12;
constexpr std::size_t kMaxCandidates = 40;  ///< pairs that are compared joint by joint
constexpr std::size_t kMaxOfLimb = 32;      ///< joints of a limb that are compared
constexpr double kInCommon = 0.5;           ///< of the shorter limb, at least, is common to matched limbs

[[nodiscard]] double distance(const JointTree& tree, JointIndex a, JointIndex b) {
  return (tree.position(a) - tree.position(b)).norm();
}

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
        const double down = distance(tree, a[i], a[k]);
        for (std::size_t l = j + 1; l < b.size(); ++l) {
          if (!tree.isBelow(b[l], b[j])) continue;
          const double other = distance(tree, b[j], b[l]);
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
  keepLongest(pairs, kMaxCandidates);
  return pairs;
}

}  // namespace

std::vector<LimbPair> regularPairs(const JointTree& tree, const Reach& reach) {
  constexpr std::size_t kMaxChildren = 8;
  std::vector<LimbPair> pairs;
  for (JointIndex branch = 0; branch < tree.jointCount(); ++branch) {
    std::vector<JointIndex> children = tree.children(branch);
    const auto whole = [&](JointIndex child) { return reach.length[child] + distance(tree, child, branch); };
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

std::vector<LimbPair> matchedPairs(const JointTree& tree, const Reach& reach) {
  std::vector<LimbPair> pairs = pairsOfTrunk(tree, reach);
  for (LimbPair& pair : pairs) match(tree, pair);
  std::erase_if(pairs, [&](const LimbPair& pair) {
    const double shorter = std::min(reach.length[pair.tops[0]], reach.length[pair.tops[1]]);
    return pair.ways[0].size() < 2 || pair.length < kInCommon * shorter;
  });
  keepLongest(pairs, kMaxPairs);
  return pairs;
}

std::vector<LimbPair> lopsidedPairs(const JointTree& tree, const Reach& reach, const LimbPair& legs) {
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

}  // namespace lorica
