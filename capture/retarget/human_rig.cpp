#include "capture/retarget/human_rig.h"

#include <algorithm>

namespace lorica {
namespace {

constexpr double kShortestLimb = 1e-4;

}  // namespace

Result<HumanRig> HumanRig::create(const Skeleton& skeleton) {
  LORICA_TRY(RetargetRig rig, RetargetRig::create(skeleton));
  return HumanRig(std::move(rig));
}

HumanRig::HumanRig(RetargetRig ofSkeleton) : PosedBody(std::move(ofSkeleton)), tposeFromJoint_(rig.tposeFromJoint) {
  using B = HumanBone;
  const Skeleton& skeleton = rig.skeleton;
  for (const B bone : {B::kHips, B::kSpine, B::kChest, B::kUpperChest}) {
    if (skeleton.jointOf(bone) != kNoJoint) spine_.push_back(bone);
  }
  if (const JointIndex neck = skeleton.jointOf(B::kNeck); neck != kNoJoint) {
    const Quat upright = swingBetween(rig.neckAxis, Vec3::UnitY(), Vec3::UnitX());
    tposeFromJoint_[neck] = upright * tposeFromJoint_[neck];
  }
  for (std::size_t side = 0; side < 2; ++side) {
    for (const B bone : {side == 0 ? B::kLeftFoot : B::kRightFoot, side == 0 ? B::kLeftToes : B::kRightToes}) {
      const JointIndex joint = skeleton.jointOf(bone);
      if (joint == kNoJoint) continue;
      tposeFromJoint_[joint] = rig.toesHeading[side].conjugate() * tposeFromJoint_[joint];
    }
  }
}

HumanPose HumanRig::read(std::span<const JointTransform> pose) {
  evaluate(pose);
  HumanPose human;
  const auto turnOf = [&](HumanBone bone) -> std::optional<Quat>& {
    return human.turn[static_cast<std::size_t>(bone)];
  };
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const std::optional<HumanBone> bone = rig.skeleton.joint(static_cast<JointIndex>(j)).bone;
    if (bone) turnOf(*bone) = (worldRotation[j] * tposeFromJoint_[j].conjugate()).normalized();
  }
  // Joints between a limb's two ends, and joints that translate relative to their parent, bend it too: use its ends for
  // the direction.
  for (const LimbBones& limb : limbs()) {
    const auto point = [&](HumanBone bone, HumanBone next) {
      const Vec3 along = positionOf(next) - positionOf(bone);
      const double length = along.norm();
      if (length < kShortestLimb) return;
      turnOf(bone) = pointed(*turnOf(bone), limb.axis, along / length, limb.hinge);
    };
    point(limb.upper, limb.lower);
    point(limb.lower, limb.end);
  }
  human.middleHip = middleHip();
  for (int side = 0; side < 2; ++side) human.foot[side] = foot(side);
  return human;
}

std::vector<Quat> HumanRig::spineTurnsOf(const HumanPose& human) const {
  std::vector<Quat> turns;
  turns.reserve(spine_.size());
  for (const HumanBone bone : spine_) turns.push_back(*human[bone]);
  return turns;
}

void HumanRig::pose(const HumanPose& human, std::span<const Quat> spineTurns, std::span<JointTransform> pose) {
  using B = HumanBone;
  const Skeleton& skeleton = rig.skeleton;
  LORICA_CHECK(pose.size() == skeleton.joints().size() && !spineTurns.empty(), "the pose must match the skeleton");
  const auto spineTurn = [&](std::size_t i) {
    const double along = static_cast<double>(i * (spineTurns.size() - 1)) / static_cast<double>(spine_.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(along), spineTurns.size() - 1);
    const std::size_t above = std::min(below + 1, spineTurns.size() - 1);
    return spineTurns[below].slerp(along - static_cast<double>(below), spineTurns[above]);
  };
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const Joint& joint = skeleton.joint(static_cast<JointIndex>(j));
    const Quat above = joint.parent == kNoJoint ? Quat::Identity() : worldRotation[joint.parent];
    pose[j] = joint.rest;
    std::optional<Quat> turn;
    if (joint.bone) {
      const auto onSpine = std::find(spine_.begin(), spine_.end(), *joint.bone);
      if (onSpine != spine_.end()) {
        turn = spineTurn(static_cast<std::size_t>(onSpine - spine_.begin()));
      } else if (human[*joint.bone]) {
        turn = human[*joint.bone];
      } else if (*joint.bone == B::kNeck && human[B::kHead]) {
        turn = spineTurns.back().slerp(0.5, *human[B::kHead]);
      }
    }
    if (turn) pose[j].rotation = (above.conjugate() * *turn * tposeFromJoint_[j]).normalized();
    worldRotation[j] = (above * pose[j].rotation).normalized();
  }
  computeWorldFromJoint(skeleton, pose, worldFromJoint);
}

}  // namespace lorica
