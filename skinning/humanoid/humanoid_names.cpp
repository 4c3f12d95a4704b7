#include "skinning/humanoid/humanoid_names.h"

#include "skinning/humanoid/humanoid_tables.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

namespace lorica {

namespace {

using enum HumanBone;

struct Candidate {
  JointIndex joint = kNoJoint;
  int rank = 0;  ///< lower is better
};
using Candidates = std::vector<Candidate>;

/// Maximum candidates per bone; keeps the search short.
constexpr std::size_t kMaxCandidates = 6;

struct ChainBone {
  HumanBone bone;
  int weight;
};
constexpr std::array<ChainBone, 4> kLeg = {{{kLeftUpperLeg, 3}, {kLeftLowerLeg, 3}, {kLeftFoot, 2}, {kLeftToes, 1}}};
constexpr std::array<ChainBone, 5> kArm = {
    {{kLeftShoulder, 1}, {kLeftUpperArm, 3}, {kLeftLowerArm, 3}, {kLeftHand, 2}, {kLeftMiddleProximal, 1}}};
constexpr std::array<ChainBone, 2> kHeadChain = {{{kNeck, 1}, {kHead, 2}}};

[[nodiscard]] HumanBone ofSide(HumanBone bone, Side side) {
  return side == Side::kRight ? mirrored(bone) : bone;
}

/// The meaning of a name in a convention.
struct NameRow {
  HumanBone bone;
  int rank;
};
using NameRows = std::map<std::string, std::vector<NameRow>>;

[[nodiscard]] NameRows readRows(const NamingConvention& convention) {
  NameRows rows;
  for (std::size_t b = 0; b < kNamedBones.size(); ++b) {
    std::string_view rest = convention.names[b];
    for (int rank = 0; !rest.empty(); ++rank) {
      const std::size_t blank = rest.find(' ');
      rows[std::string(rest.substr(0, blank))].push_back({kNamedBones[b], rank});
      rest = blank == std::string_view::npos ? std::string_view() : rest.substr(blank + 1);
    }
  }
  return rows;
}

/// One entry per naming convention, parsed once.
[[nodiscard]] const std::vector<NameRows>& rowsOfConventions() {
  static const std::vector<NameRows> all = [] {
    std::vector<NameRows> made;
    made.reserve(std::size(kNamingConventions));
    for (const NamingConvention& convention : kNamingConventions) made.push_back(readRows(convention));
    return made;
  }();
  return all;
}

/// Candidate joints for each bone by the names of a convention; all joints of the trunk are under kSpine.
class ConventionMatch {
 public:
  ConventionMatch(const NameRows& rows, std::span<const JointName> names, const BoneJoints& given) : rows_(rows) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!isUsed(given, i)) addCandidates(i, names[i]);
    }
    for (std::size_t bone = 0; bone < kHumanBoneCount; ++bone) {
      Candidates& all = candidates_[bone];
      if (given[bone] != kNoJoint) all = {{given[bone], 0}};
      if (bone == ordinalOf(kSpine)) continue;
      std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; });
      if (all.size() > kMaxCandidates) all.resize(kMaxCandidates);
    }
  }

  [[nodiscard]] const Candidates& of(HumanBone bone) const { return candidates_[ordinalOf(bone)]; }

 private:
  /// @return whether the key names a bone of this side
  bool add(JointIndex joint, const std::string& key, Side side, int preference) {
    const auto found = rows_.find(key);
    if (found == rows_.end()) return false;
    bool added = false;
    for (const NameRow& row : found->second) {
      const bool sided = mirrored(row.bone) != row.bone;
      if (sided != (side != Side::kMiddle)) continue;
      candidates_[ordinalOf(ofSide(row.bone, side))].push_back({joint, row.rank * 4 + preference});
      added = true;
    }
    return added;
  }

  void addCandidates(JointIndex joint, const JointName& name) {
    const std::string key = name.key();
    if (key.empty()) return;
    if (add(joint, key, name.side, name.preference)) return;
    const std::string plain = withoutLeadingZeros(key);
    if (add(joint, plain, name.side, name.preference)) return;
    if (name.side != Side::kMiddle) return;
    // "lfemur", "rShldr": a side attached to the start or end of the name.
    const auto sideOf = [](char c) { return c == 'l' ? Side::kLeft : c == 'r' ? Side::kRight : Side::kMiddle; };
    if (const Side side = sideOf(plain.front()); side != Side::kMiddle) {
      if (add(joint, plain.substr(1), side, name.preference)) return;
    }
    if (const Side side = sideOf(plain.back()); side != Side::kMiddle) {
      add(joint, plain.substr(0, plain.size() - 1), side, name.preference);
    }
  }

  const NameRows& rows_;
  std::array<Candidates, kHumanBoneCount> candidates_;
};

/// Finds the assignment of joints to a chain of bones, each below the one before, that has the largest weight; on ties
/// the one with the best names.
class ChainSearch {
 public:
  ChainSearch(const JointTree& tree, const ConventionMatch& match, std::span<const ChainBone> chain, Side side)
      : tree_(tree), match_(match), chain_(chain), side_(side), current_(chain.size(), kNoJoint), best_(current_) {
    search(0, kNoJoint, 0, 0);
  }
  [[nodiscard]] int weight() const { return bestWeight_; }
  void write(BoneJoints& bones) const {
    for (std::size_t i = 0; i < chain_.size(); ++i) jointOf(bones, ofSide(chain_[i].bone, side_)) = best_[i];
  }

 private:
  void search(std::size_t i, JointIndex above, int weight, int rank) {
    if (i == chain_.size()) {
      if (weight < bestWeight_ || (weight == bestWeight_ && rank >= bestRank_)) return;
      bestWeight_ = weight;
      bestRank_ = rank;
      best_ = current_;
      return;
    }
    for (const Candidate& candidate : match_.of(ofSide(chain_[i].bone, side_))) {
      if (above != kNoJoint && !tree_.isBelow(candidate.joint, above)) continue;
      current_[i] = candidate.joint;
      search(i + 1, candidate.joint, weight + chain_[i].weight, rank + candidate.rank);
    }
    current_[i] = kNoJoint;
    search(i + 1, above, weight, rank);
  }

  const JointTree& tree_;
  const ConventionMatch& match_;
  std::span<const ChainBone> chain_;
  Side side_;
  std::vector<JointIndex> current_;
  std::vector<JointIndex> best_;
  int bestWeight_ = 0;
  int bestRank_ = 0;
};

[[nodiscard]] bool has(const BoneJoints& bones, HumanBone bone) {
  return jointOf(bones, bone) != kNoJoint;
}

[[nodiscard]] bool isAmong(const Candidates& named, JointIndex joint) {
  return std::ranges::find(named, joint, &Candidate::joint) != named.end();
}

/// The joint with the best name that carries legs and trunk, on ties the lowest; else the joint where these meet.
[[nodiscard]] JointIndex findHips(const JointTree& tree, const Candidates& named, JointIndex meeting) {
  Candidate best;
  for (const Candidate& candidate : named) {
    if (!tree.isBelowOrSame(meeting, candidate.joint)) continue;
    const bool better = best.joint == kNoJoint || candidate.rank < best.rank ||
                        (candidate.rank == best.rank && tree.isBelow(candidate.joint, best.joint));
    if (better) best = candidate;
  }
  return best.joint != kNoJoint ? best.joint : meeting;
}

/// The end of a trunk without arms and head: the last of its named joints, each below the one before.
[[nodiscard]] JointIndex lastOfTrunk(const JointTree& tree, const Candidates& named, JointIndex hips) {
  JointIndex last = kNoJoint;
  for (const Candidate& candidate : named) {
    if (tree.isBelow(candidate.joint, last == kNoJoint ? hips : last)) last = candidate.joint;
  }
  return last;
}

void removeUnless(bool keep, HumanBone bone, BoneJoints& bones) {
  if (!keep) jointOf(bones, bone) = kNoJoint;
}

/// @return the weight of all bones; 0 if hips or legs are missing
[[nodiscard]] int solve(const JointTree& tree, std::span<const JointName> names, const ConventionMatch& match,
                        const BoneJoints& given, BoneJoints& bones) {
  bones.fill(kNoJoint);
  int weight = 0;
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const ChainSearch leg(tree, match, kLeg, side);
    leg.write(bones);
    weight += leg.weight();
  }
  for (const HumanBone bone : {kLeftUpperLeg, kRightUpperLeg, kLeftLowerLeg, kRightLowerLeg}) {
    if (!has(bones, bone)) return 0;
  }
  const JointIndex leftLeg = jointOf(bones, kLeftUpperLeg);
  const JointIndex rightLeg = jointOf(bones, kRightUpperLeg);
  if (tree.isBelowOrSame(leftLeg, rightLeg) || tree.isBelow(rightLeg, leftLeg)) return 0;
  const JointIndex legs = tree.commonAncestor(leftLeg, rightLeg);
  if (legs == kNoJoint) return 0;

  std::array<int, 2> armWeight{};
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const ChainSearch arm(tree, match, kArm, side);
    arm.write(bones);
    armWeight[side == Side::kLeft ? 0 : 1] = arm.weight();
  }
  const bool bothArms = has(bones, kLeftUpperArm) == has(bones, kRightUpperArm) &&
                        has(bones, kLeftLowerArm) == has(bones, kRightLowerArm);
  if (!bothArms) return 0;
  // A puppet's arm is one joint, often named hand: use it as the upper arm, so that it moves.
  for (const Side side : {Side::kLeft, Side::kRight}) {
    JointIndex& hand = jointOf(bones, ofSide(kLeftHand, side));
    JointIndex& arm = jointOf(bones, ofSide(kLeftUpperArm, side));
    if (hand == kNoJoint || arm != kNoJoint || has(bones, ofSide(kLeftLowerArm, side))) continue;
    arm = hand;
    hand = kNoJoint;
  }
  weight += armWeight[0] + armWeight[1];

  const ChainSearch headChain(tree, match, kHeadChain, Side::kMiddle);
  headChain.write(bones);
  weight += headChain.weight();

  const JointIndex meeting = tree.commonAncestor(legs, topOfTrunk(tree, bones));
  if (meeting == kNoJoint) return 0;
  JointIndex& hips = jointOf(bones, kHips);
  hips = given[ordinalOf(kHips)];
  if (hips == kNoJoint) hips = findHips(tree, match.of(kHips), meeting);
  if (!tree.isBelowOrSame(meeting, hips) || hips == leftLeg || hips == rightLeg) return 0;
  weight += isAmong(match.of(kHips), hips) ? 1 : 0;
  // Rigify's hips are named spine as well: a joint may be only one bone.
  removeUnless(jointOf(bones, kNeck) != hips, kNeck, bones);
  removeUnless(jointOf(bones, kHead) != hips, kHead, bones);

  // Conventions are scored by the trunk joints that they name; other joints are used only after that.
  std::vector<JointIndex> trunk;
  const bool armsOrHead = topOfTrunk(tree, bones) != kNoJoint && topOfTrunk(tree, bones) != hips;
  if (armsOrHead) {
    trunk = trunkJoints(tree, names, bones);
  } else if (const JointIndex last = lastOfTrunk(tree, match.of(kSpine), hips); last != kNoJoint) {
    trunk = tree.pathBelow(hips, last);
  }
  std::erase_if(trunk, [&](JointIndex joint) { return !isAmong(match.of(kSpine), joint) || isUsed(bones, joint); });
  const bool trunkGiven = given[ordinalOf(kSpine)] != kNoJoint || given[ordinalOf(kChest)] != kNoJoint ||
                          given[ordinalOf(kUpperChest)] != kNoJoint;
  if (!trunkGiven) assignTrunk(trunk, bones);
  weight += countOf(trunk);

  for (std::size_t bone = 0; bone < bones.size(); ++bone) {
    if (given[bone] != kNoJoint) bones[bone] = given[bone];
  }
  return weight;
}

/// For a skeleton without both legs, such as that of an upper-body sensor. It must have two complete arms on one trunk.
/// @return the weight of all bones; 0 if arms or trunk are missing
[[nodiscard]] int solveWithoutLegs(const JointTree& tree, const ConventionMatch& match, BoneJoints& bones) {
  bones.fill(kNoJoint);
  int weight = 0;
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const ChainSearch leg(tree, match, kLeg, side);
    const ChainSearch arm(tree, match, kArm, side);
    leg.write(bones);
    arm.write(bones);
    weight += leg.weight() + arm.weight();
  }
  for (const HumanBone bone : {kLeftUpperArm, kRightUpperArm, kLeftLowerArm, kRightLowerArm}) {
    if (!has(bones, bone)) return 0;
  }
  const JointIndex leftArm = jointOf(bones, kLeftUpperArm);
  const JointIndex rightArm = jointOf(bones, kRightUpperArm);
  if (tree.isBelowOrSame(leftArm, rightArm) || tree.isBelow(rightArm, leftArm)) return 0;
  const ChainSearch headChain(tree, match, kHeadChain, Side::kMiddle);
  headChain.write(bones);
  weight += headChain.weight();

  const JointIndex top = topOfTrunk(tree, bones);
  if (top == kNoJoint || isUsed(bones, top)) return 0;
  const auto best = [&](HumanBone bone) {
    for (const Candidate& candidate : match.of(bone)) {
      if (tree.isBelowOrSame(top, candidate.joint) && !isUsed(bones, candidate.joint)) return candidate.joint;
    }
    return kNoJoint;
  };
  jointOf(bones, kHips) = best(kHips);
  std::vector<JointIndex> trunk;
  for (JointIndex joint = top; joint != kNoJoint && joint != jointOf(bones, kHips); joint = tree.parent(joint)) {
    if (isAmong(match.of(kSpine), joint)) trunk.insert(trunk.begin(), joint);
  }
  weight += countOf(trunk);
  if (trunk.empty() && !has(bones, kHips)) trunk.push_back(top);
  assignTrunk(trunk, bones);
  return weight;
}

}  // namespace

JointIndex topOfTrunk(const JointTree& tree, const BoneJoints& bones) {
  JointIndex top = kNoJoint;
  for (const HumanBone bone : {kLeftUpperArm, kRightUpperArm}) {
    const JointIndex arm = jointOf(bones, bone);
    if (arm != kNoJoint) top = tree.commonAncestor(top, arm);
  }
  // In some rigs the arms are children of the neck; then the trunk ends at the neck's parent.
  const JointIndex neck = has(bones, kNeck) ? jointOf(bones, kNeck) : jointOf(bones, kHead);
  if (neck == kNoJoint) return top;
  const JointIndex belowNeck = tree.parent(neck) == kNoJoint ? neck : tree.parent(neck);
  return tree.commonAncestor(top, belowNeck);
}

std::vector<JointIndex> trunkJoints(const JointTree& tree, std::span<const JointName> names, const BoneJoints& bones) {
  const JointIndex top = topOfTrunk(tree, bones);
  const JointIndex hips = jointOf(bones, kHips);
  if (top == kNoJoint || hips == kNoJoint || !tree.isBelow(top, hips)) return {};
  std::vector<JointIndex> trunk = tree.pathBelow(hips, top);
  std::erase_if(trunk, [&](JointIndex joint) { return isUsed(bones, joint) || isHelper(names[joint]); });
  // Biped's thighs are children of its first spine joint, which would swing the legs: only use the joints above it.
  const auto carriesLeg = [&](JointIndex joint) {
    return tree.isBelow(jointOf(bones, kLeftUpperLeg), joint) || tree.isBelow(jointOf(bones, kRightUpperLeg), joint);
  };
  if (!std::all_of(trunk.begin(), trunk.end(), carriesLeg)) std::erase_if(trunk, carriesLeg);
  return trunk;
}

void assignTrunk(std::span<const JointIndex> fromHipsUp, BoneJoints& bones) {
  const std::size_t count = fromHipsUp.size();
  if (count == 0) return;
  jointOf(bones, kSpine) = fromHipsUp.front();
  if (count == 2) jointOf(bones, kChest) = fromHipsUp.back();
  if (count < 3) return;
  jointOf(bones, kChest) = fromHipsUp[count / 2];
  jointOf(bones, kUpperChest) = fromHipsUp.back();
}

namespace {

/// The bones by the convention that gives them the largest weight.
/// @param solve  finds the bones by one convention. @return their weight
[[nodiscard]] NamedBones byBestConvention(std::span<const JointName> names, const BoneJoints& given,
                                          const auto& solve) {
  NamedBones best;
  best.jointOf = given;
  int bestWeight = 0;
  for (std::size_t c = 0; c < std::size(kNamingConventions); ++c) {
    BoneJoints bones;
    const int weight = solve(ConventionMatch(rowsOfConventions()[c], names, given), bones);
    if (weight <= bestWeight) continue;
    bestWeight = weight;
    best.jointOf = bones;
    best.convention = kNamingConventions[c].name;
  }
  return best;
}

[[nodiscard]] BoneJoints noBones() {
  BoneJoints none;
  none.fill(kNoJoint);
  return none;
}

}  // namespace

NamedBones bonesByNames(const JointTree& tree, std::span<const JointName> names, const BoneJoints& given) {
  return byBestConvention(names, given, [&](const ConventionMatch& match, BoneJoints& bones) {
    return solve(tree, names, match, given, bones);
  });
}

NamedBones upperBodyByNames(const JointTree& tree, std::span<const JointName> names) {
  return byBestConvention(names, noBones(), [&](const ConventionMatch& match, BoneJoints& bones) {
    return solveWithoutLegs(tree, match, bones);
  });
}

namespace {

/// Bones by names alone, and the joints of the trunk from the hips up.
struct FlatBones {
  BoneJoints jointOf{};
  std::vector<JointIndex> trunk;
  int count = 0;
};

[[nodiscard]] FlatBones flatBones(const JointTree& tree, const ConventionMatch& match,
                                  std::span<const JointIndex> flat) {
  FlatBones bones;
  bones.jointOf.fill(kNoJoint);
  const auto isFree = [&](JointIndex joint) {
    return std::find(flat.begin(), flat.end(), joint) != flat.end() && !isUsed(bones.jointOf, joint);
  };
  for (int b = 0; b < kHumanBoneCount; ++b) {
    const auto bone = static_cast<HumanBone>(b);
    if (bone == kSpine) continue;
    for (const Candidate& candidate : match.of(bone)) {
      if (!isFree(candidate.joint)) continue;
      jointOf(bones.jointOf, bone) = candidate.joint;
      ++bones.count;
      break;
    }
  }
  if (!has(bones.jointOf, kHips)) return bones;
  for (const Candidate& candidate : match.of(kSpine)) {
    if (isFree(candidate.joint)) bones.trunk.push_back(candidate.joint);
  }
  const auto fromHips = [&](JointIndex joint) { return tree.distance(joint, jointOf(bones.jointOf, kHips)); };
  std::stable_sort(bones.trunk.begin(), bones.trunk.end(),
                   [&](JointIndex a, JointIndex b) { return fromHips(a) < fromHips(b); });
  bones.count += countOf(bones.trunk);
  return bones;
}

/// The joint that the number at the end of a name continues: of "finger2" that of "finger1", on the same side.
[[nodiscard]] JointIndex previousInChain(std::span<const JointName> names, std::span<const JointIndex> flat,
                                         JointIndex joint) {
  std::string key = withoutLeadingZeros(names[joint].key());
  if (key.empty() || key.back() < '2' || key.back() > '9') return kNoJoint;
  --key.back();
  for (const JointIndex other : flat) {
    if (names[other].side == names[joint].side && withoutLeadingZeros(names[other].key()) == key) return other;
  }
  return kNoJoint;
}

}  // namespace

std::vector<JointIndex> parentsByNames(const JointTree& tree, std::span<const JointName> names,
                                       std::span<const JointIndex> flat) {
  FlatBones best;
  for (const NameRows& rows : rowsOfConventions()) {
    FlatBones bones = flatBones(tree, ConventionMatch(rows, names, noBones()), flat);
    if (bones.count > best.count) best = std::move(bones);
  }
  constexpr int kFewest = 8;
  if (best.count < kFewest) return {};
  for (const HumanBone bone : {kHips, kLeftUpperLeg, kRightUpperLeg, kLeftUpperArm, kRightUpperArm}) {
    if (!has(best.jointOf, bone)) return {};
  }

  const JointIndex hips = jointOf(best.jointOf, kHips);
  const JointIndex top = best.trunk.empty() ? hips : best.trunk.back();
  std::vector<JointIndex> parents(flat.size(), kNoJoint);
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const JointIndex joint = flat[i];
    if (joint == hips) continue;
    const auto trunk = std::find(best.trunk.begin(), best.trunk.end(), joint);
    const auto bone = std::find(best.jointOf.begin(), best.jointOf.end(), joint);
    if (trunk != best.trunk.end()) {
      parents[i] = trunk == best.trunk.begin() ? hips : *(trunk - 1);
    } else if (bone != best.jointOf.end()) {
      std::optional<HumanBone> above = parentBone(static_cast<HumanBone>(bone - best.jointOf.begin()));
      while (above && jointOf(best.jointOf, *above) == kNoJoint && *above != kUpperChest) above = parentBone(*above);
      parents[i] = !above || *above == kUpperChest ? top : jointOf(best.jointOf, *above);
    } else if (parents[i] = previousInChain(names, flat, joint); parents[i] == kNoJoint) {
      double nearest = kInfinity;
      const auto consider = [&](JointIndex other) {
        if (other == kNoJoint) return;
        const double distance = tree.distance(other, joint);
        if (!(distance < nearest)) return;
        nearest = distance;
        parents[i] = other;
      };
      std::for_each(best.jointOf.begin(), best.jointOf.end(), consider);
      std::for_each(best.trunk.begin(), best.trunk.end(), consider);
    }
  }
  return parents;
}

}  // namespace lorica
