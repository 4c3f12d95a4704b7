#include "skinning/humanoid/humanoid.h"
#include "skinning/humanoid/humanoid_limbs.h"
#include "skinning/humanoid/humanoid_names.h"
#include "skinning/humanoid/humanoid_shape.h"
#include "skinning/humanoid/humanoid_words.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <algorithm>
#include <array>
#include <optional>

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

}  // namespace

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
