#include "skinning/humanoid/humanoid_tree.h"

#include "skinning/humanoid/humanoid_names.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace lorica {

JointTree::JointTree(const Skeleton& skeleton) {
  const std::size_t count = skeleton.joints().size();
  std::vector<Affine3> worldFromJoint(count);
  computeWorldFromJoint(skeleton, restPose(skeleton), worldFromJoint);
  parent_.reserve(count);
  position_.reserve(count);
  children_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const JointIndex parent = skeleton.joints()[i].parent;
    parent_.push_back(parent);
    position_.push_back(worldFromJoint[i].translation());
    if (parent != kNoJoint) children_[at(parent)].push_back(i);
  }

  // Sizes from the leaves up, then numbers from the roots down: no recursion, because a file may contain a very long
  // chain.
  std::vector<int> size(count, 1);
  for (std::size_t i = count; i-- > 0;) {
    if (parent_[i] != kNoJoint) size[at(parent_[i])] += size[i];
  }
  entered_.resize(count);
  left_.resize(count);
  int nextRoot = 0;
  std::vector<int> nextChild(count);
  for (std::size_t i = 0; i < count; ++i) {
    int& next = parent_[i] == kNoJoint ? nextRoot : nextChild[at(parent_[i])];
    entered_[i] = next;
    next += size[i];
    left_[i] = next;
    nextChild[i] = entered_[i] + 1;
  }
}

bool JointTree::isBelow(JointIndex joint, JointIndex ancestor) const {
  return joint != kNoJoint && joint != ancestor && entered_[at(ancestor)] <= entered_[at(joint)] &&
         entered_[at(joint)] < left_[at(ancestor)];
}

JointIndex JointTree::commonAncestor(JointIndex a, JointIndex b) const {
  if (a == kNoJoint) return b;
  if (b == kNoJoint) return a;
  while (a != kNoJoint && !isBelowOrSame(b, a)) a = parent(a);
  return a;
}

std::vector<JointIndex> JointTree::pathBelow(JointIndex top, JointIndex bottom) const {
  std::vector<JointIndex> path;
  for (JointIndex joint = bottom; joint != top && joint != kNoJoint; joint = parent(joint)) path.push_back(joint);
  std::reverse(path.begin(), path.end());
  return path;
}

namespace {

using enum HumanBone;

enum class Segment { kMetacarpal, kProximal, kIntermediate, kDistal, kNumbered };

struct FingerName {
  int finger = 0;  ///< 0 = thumb to 4 = little finger
  Segment segment = Segment::kNumbered;
};

/// A word split into its letters and the number at its end.
struct LettersAndNumber {
  std::string letters;
  std::string number;
};

[[nodiscard]] LettersAndNumber takeApart(const std::string& word) {
  std::size_t end = word.size();
  while (end > 0 && word[end - 1] >= '0' && word[end - 1] <= '9') --end;
  return {word.substr(0, end), word.substr(end)};
}

[[nodiscard]] std::optional<int> fingerCalled(std::string_view letters) {
  constexpr std::string_view kNames[5][4] = {
      {"thumb", "thb", "", ""}, {"index", "indx", "pointer", "forefinger"}, {"middle", "mid", "", ""},
      {"ring", "", "", ""},     {"little", "pinky", "pinkie", "pink"},
  };
  for (int finger = 0; finger < 5; ++finger) {
    for (const std::string_view name : kNames[finger]) {
      if (!name.empty() && name == letters) return finger;
    }
  }
  return std::nullopt;
}

[[nodiscard]] std::optional<Segment> segmentCalled(std::string_view letters) {
  if (letters == "metacarpal" || letters == "palm" || letters == "in" || letters == "meta") return Segment::kMetacarpal;
  if (letters == "proximal" || letters == "prox") return Segment::kProximal;
  if (letters == "intermediate" || letters == "inter" || letters == "medial") return Segment::kIntermediate;
  if (letters == "distal" || letters == "dist") return Segment::kDistal;
  return std::nullopt;
}

/// Parses names such as "handthumb1", "f, index, 01", "finger1, 2" (MakeHuman's thumb), "finger12" (Biped's index) and
/// "digit2, metacarpal".
/// @param thumbIsZero  whether numbered fingers start at 0
[[nodiscard]] std::optional<FingerName> readFinger(const JointName& name, bool thumbIsZero) {
  if (name.side == Side::kMiddle || name.preference == 3) return std::nullopt;
  std::optional<int> finger;
  FingerName read;
  for (const std::string& word : name.words) {
    auto [letters, number] = takeApart(word);
    if (letters.starts_with("hand") && letters.size() > 4) letters.erase(0, 4);
    if (const std::optional<int> called = fingerCalled(letters)) {
      finger = called;  // for "RingPinky1" the last one
    } else if ((letters == "finger" || letters == "digit") && !number.empty() && !finger) {
      finger = number[0] - '0' - (thumbIsZero ? 0 : 1);
      if (*finger < 0 || *finger > 4) return std::nullopt;
    } else if (const std::optional<Segment> segment = segmentCalled(letters)) {
      read.segment = *segment;
    } else {
      const bool plain = letters.empty() || letters == "hand" || letters == "finger" || letters == "f" ||
                         letters == "phalange" || letters == "phalanx" || letters == "a" || letters == "b" ||
                         letters == "c";
      if (!plain) return std::nullopt;
    }
  }
  if (!finger) return std::nullopt;
  read.finger = *finger;
  return read;
}

constexpr std::array<std::array<HumanBone, 3>, 5> kFingers = {{
    {kLeftThumbMetacarpal, kLeftThumbProximal, kLeftThumbDistal},
    {kLeftIndexProximal, kLeftIndexIntermediate, kLeftIndexDistal},
    {kLeftMiddleProximal, kLeftMiddleIntermediate, kLeftMiddleDistal},
    {kLeftRingProximal, kLeftRingIntermediate, kLeftRingDistal},
    {kLeftLittleProximal, kLeftLittleIntermediate, kLeftLittleDistal},
}};

struct NamedFinger {
  JointIndex joint;
  Segment segment;
};

/// The chain that starts at the first joint: each further joint is below the one before.
[[nodiscard]] std::vector<NamedFinger> chainOf(const JointTree& tree, const std::vector<NamedFinger>& joints) {
  std::vector<NamedFinger> chain;
  // Parents precede children, so the joints are in the order of the chain.
  for (const NamedFinger& next : joints) {
    if (chain.empty() || tree.isBelow(next.joint, chain.back().joint)) chain.push_back(next);
  }
  return chain;
}

void assignFinger(int finger, Side side, std::vector<NamedFinger> chain, BoneJoints& bones) {
  const std::array<HumanBone, 3>& row = kFingers[finger];
  if (finger > 0) std::erase_if(chain, [](const NamedFinger& f) { return f.segment == Segment::kMetacarpal; });
  const bool inWords = std::any_of(chain.begin(), chain.end(), [](const NamedFinger& f) {
    return f.segment == Segment::kProximal || f.segment == Segment::kDistal;
  });
  const bool hasIntermediate =
      std::any_of(chain.begin(), chain.end(), [](const NamedFinger& f) { return f.segment == Segment::kIntermediate; });
  std::size_t next = 0;
  // VRM 1.0 calls a thumb's bones metacarpal, proximal, distal; VRM 0.x proximal, intermediate, distal.
  if (finger == 0 && inWords && !hasIntermediate && chain.front().segment == Segment::kProximal) next = 1;
  for (const NamedFinger& joint : chain) {
    if (next == row.size()) break;
    const HumanBone bone = side == Side::kRight ? mirrored(row[next]) : row[next];
    if (jointOf(bones, bone) == kNoJoint) jointOf(bones, bone) = joint.joint;
    ++next;
  }
}

/// Joints of a path that are examined. Longer paths belong to ornaments, not limbs.
constexpr std::size_t kMaxOnWay = 16;

/// Joints closer together than this fraction of a limb's length coincide.
constexpr double kSamePosition = 1e-3;

[[nodiscard]] double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The largest distance of the joints between two ends of a path from the straight line between these ends [m].
[[nodiscard]] double bulge(const JointTree& tree, std::span<const JointIndex> way, std::size_t from, std::size_t to) {
  const Vec3& start = tree.position(way[from]);
  const Vec3 along = tree.position(way[to]) - start;
  const double lengthSq = std::max(along.squaredNorm(), 1e-300);
  double farthest = 0.0;
  for (std::size_t i = from + 1; i < to; ++i) {
    const Vec3 offset = tree.position(way[i]) - start;
    const double t = std::clamp(offset.dot(along) / lengthSq, 0.0, 1.0);
    farthest = std::max(farthest, (offset - t * along).norm());
  }
  return farthest;
}

/// How well three joints of a path form a limb; the weights were tuned on the skeletons of the tests.
[[nodiscard]] double splitScore(const JointTree& tree, std::span<const JointIndex> way, LimbKind kind,
                                double wholeLength, const std::array<std::size_t, 3>& at) {
  const Vec3 upper = tree.position(way[at[1]]) - tree.position(way[at[0]]);
  const Vec3 lower = tree.position(way[at[2]]) - tree.position(way[at[1]]);
  const double longer = std::max(upper.norm(), lower.norm());
  if (std::min(upper.norm(), lower.norm()) < kSamePosition * wholeLength) return -1.0;
  double score = std::min(upper.norm(), lower.norm()) / longer;
  score += 0.3 * (upper.norm() + lower.norm()) / wholeLength;
  // A collar bone may precede, a hand or foot may follow; anything longer is a part of the limb left out.
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    if (i <= at[0]) before += tree.distance(way[i - 1], way[i]);
    if (i > at[2]) after += tree.distance(way[i - 1], way[i]);
  }
  const double both = upper.norm() + lower.norm();
  score -= 0.5 * std::max(0.0, before / both - 0.4) + std::max(0.0, after / both - 0.35);
  score -= 0.1 * (at[2] - at[0] - 2);
  score -= 3.0 * (bulge(tree, way, at[0], at[1]) + bulge(tree, way, at[1], at[2])) / wholeLength;
  if (kind == LimbKind::kArm && tree.children(way[at[2]]).size() >= 3) score += 0.5;
  if (kind == LimbKind::kLeg && at[2] + 1 < way.size()) {
    const Vec3 foot = tree.position(way[at[2] + 1]) - tree.position(way[at[2]]);
    if (foot.norm() > kSamePosition * wholeLength) score += 0.3 * std::min(1.0, angleBetween(lower, foot) / 1.0);
  }
  return score;
}

}  // namespace

Reach::Reach(const JointTree& tree) {
  const std::size_t count = tree.jointCount();
  length.assign(count, 0.0);
  next.assign(count, kNoJoint);
  size.assign(count, 1);
  for (std::size_t i = count; i-- > 0;) {
    const JointIndex joint = i;
    const JointIndex parent = tree.parent(joint);
    if (parent == kNoJoint) continue;
    const std::size_t p = parent;
    size[p] += size[i];
    // On ties the first child: children are visited in reverse order.
    const double reached = length[i] + tree.distance(joint, parent);
    if (next[p] != kNoJoint && reached < length[p]) continue;
    length[p] = reached;
    next[p] = joint;
  }
}

std::vector<JointIndex> Reach::wayDown(JointIndex joint) const {
  std::vector<JointIndex> way;
  for (; joint != kNoJoint && way.size() < kMaxOnWay; joint = next[joint]) way.push_back(joint);
  return way;
}

Limb splitLimb(const JointTree& tree, std::span<const JointIndex> way, LimbKind kind) {
  Limb limb;
  if (way.empty()) return limb;
  limb.upper = way[0];
  if (way.size() == 1) return limb;
  limb.lower = way[1];
  if (way.size() == 2) return limb;

  double wholeLength = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) wholeLength += tree.distance(way[i - 1], way[i]);
  std::array<std::size_t, 3> best = {0, 1, 2};
  double bestScore = -1e300;
  for (std::size_t i = 0; i < way.size(); ++i) {
    for (std::size_t j = i + 1; j < way.size(); ++j) {
      for (std::size_t k = j + 1; k < way.size(); ++k) {
        const double score = splitScore(tree, way, kind, wholeLength, {i, j, k});
        // Mirrored limbs differ by rounding: an equal score must not win.
        if (score <= bestScore + 1e-6) continue;
        bestScore = score;
        best = {i, j, k};
      }
    }
  }
  limb.upper = way[best[0]];
  limb.lower = way[best[1]];
  limb.end = way[best[2]];
  for (std::size_t i = best[2] + 1; i < way.size() && limb.beyond == kNoJoint; ++i) {
    if (tree.distance(way[i], limb.end) > kSamePosition * wholeLength) limb.beyond = way[i];
  }
  return limb;
}

namespace {

/// Two or three joints of a finger, starting at its knuckle.
[[nodiscard]] std::vector<JointIndex> fingerJoints(const JointTree& tree, const Reach& reach, JointIndex hand,
                                                   JointIndex first, bool thumb) {
  std::vector<JointIndex> way = reach.wayDown(first);
  // A finger's metacarpal starts at the wrist and is longer than its distance from the hand.
  if (!thumb && way.size() > 3 && tree.distance(hand, way[0]) < tree.distance(way[0], way[1])) way.erase(way.begin());
  if (way.size() > 3) way.resize(3);
  return way;
}

}  // namespace

void addFingersByShape(const JointTree& tree, const Reach& reach, bool left, BoneJoints& bones) {
  const JointIndex hand = jointOf(bones, left ? kLeftHand : kRightHand);
  if (hand == kNoJoint) return;
  const JointIndex arm = jointOf(bones, left ? kLeftLowerArm : kRightLowerArm);
  std::vector<JointIndex> fingers;
  for (const JointIndex child : tree.children(hand)) {
    if (reach.next[child] != kNoJoint) fingers.push_back(child);
  }
  if (arm == kNoJoint || fingers.size() < 3 || fingers.size() > 5) return;

  // The thumb's tip extends least along the forearm's direction; the others are ordered across the palm, from the
  // thumb.
  const Vec3 along = (tree.position(hand) - tree.position(arm)).normalized();
  const auto tip = [&](JointIndex finger) { return tree.position(reach.wayDown(finger).back()); };
  const auto reached = [&](JointIndex finger) { return (tip(finger) - tree.position(hand)).dot(along); };
  std::stable_sort(fingers.begin(), fingers.end(), [&](JointIndex a, JointIndex b) { return reached(a) < reached(b); });
  const JointIndex thumb = fingers.front();
  fingers.erase(fingers.begin());
  // The first joints may all coincide; then the second ones carry the offset.
  const auto knuckle = [&](JointIndex finger) {
    return tree.position(fingerJoints(tree, reach, hand, finger, false).at(1));
  };
  Vec3 across = Vec3::Zero();
  for (const JointIndex a : fingers) {
    for (const JointIndex b : fingers) {
      Vec3 between = knuckle(b) - knuckle(a);
      between -= between.dot(along) * along;
      if (between.norm() > across.norm()) across = between;
    }
  }
  Vec3 middle = Vec3::Zero();
  for (const JointIndex finger : fingers) middle += knuckle(finger) / countOf(fingers);
  const Vec3 thumbKnuckle = tree.position(fingerJoints(tree, reach, hand, thumb, true).back());
  if (across.dot(middle - thumbKnuckle) < 0.0) across = -across;
  std::stable_sort(fingers.begin(), fingers.end(),
                   [&](JointIndex a, JointIndex b) { return knuckle(a).dot(across) < knuckle(b).dot(across); });

  fingers.insert(fingers.begin(), thumb);
  for (std::size_t finger = 0; finger < fingers.size(); ++finger) {
    const std::vector<JointIndex> joints = fingerJoints(tree, reach, hand, fingers[finger], finger == 0);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const auto bone = static_cast<HumanBone>(static_cast<std::size_t>(kLeftThumbMetacarpal) + finger * 3 + i);
      jointOf(bones, left ? bone : mirrored(bone)) = joints[i];
    }
  }
}

void addFingersByNames(const JointTree& tree, std::span<const JointName> names, BoneJoints& bones) {
  const bool thumbIsZero = std::any_of(names.begin(), names.end(), [](const JointName& name) {
    return std::any_of(name.words.begin(), name.words.end(),
                       [](const std::string& word) { return word.starts_with("finger0"); });
  });
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const JointIndex hand = jointOf(bones, side == Side::kLeft ? kLeftHand : kRightHand);
    if (hand == kNoJoint) continue;
    std::array<std::vector<NamedFinger>, 5> found;
    for (JointIndex joint = 0; joint < tree.jointCount(); ++joint) {
      const JointName& name = names[joint];
      if (name.side != side || !tree.isBelow(joint, hand)) continue;
      if (isUsed(bones, joint)) continue;
      const std::optional<FingerName> read = readFinger(name, thumbIsZero);
      if (read) found[read->finger].push_back({joint, read->segment});
    }
    for (int finger = 0; finger < 5; ++finger) {
      const std::vector<NamedFinger> chain = chainOf(tree, found[finger]);
      if (!chain.empty()) assignFinger(finger, side, chain, bones);
    }
  }
}

}  // namespace lorica
