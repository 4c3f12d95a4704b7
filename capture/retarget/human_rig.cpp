#include "capture/retarget/human_rig.h"

#include "capture/retarget/leg_reach.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr double kShortestLimb = 1e-4;

std::size_t index(JointIndex joint) {
  return static_cast<std::size_t>(joint);
}

}  // namespace

Result<HumanRig> HumanRig::create(const Skeleton& skeleton) {
  Result<RetargetRig> rig = RetargetRig::create(skeleton);
  if (!rig) return rig.error();
  return HumanRig(std::move(*rig));
}

HumanRig::HumanRig(RetargetRig rig)
    : rig_(std::move(rig)),
      tposeFromJoint_(rig_.tposeFromJoint),
      worldRotation_(tposeFromJoint_.size(), Quat::Identity()),
      worldFromJoint_(tposeFromJoint_.size()) {
  using B = HumanBone;
  const Skeleton& skeleton = rig_.skeleton;
  for (const B bone : {B::kHips, B::kSpine, B::kChest, B::kUpperChest}) {
    if (skeleton.jointOf(bone) != kNoJoint) spine_.push_back(bone);
  }
  if (const JointIndex neck = skeleton.jointOf(B::kNeck); neck != kNoJoint) {
    const Quat upright = swingBetween(rig_.neckAxis, Vec3::UnitY(), Vec3::UnitX());
    tposeFromJoint_[index(neck)] = upright * tposeFromJoint_[index(neck)];
  }
  for (std::size_t side = 0; side < 2; ++side) {
    for (const B bone : {side == 0 ? B::kLeftFoot : B::kRightFoot, side == 0 ? B::kLeftToes : B::kRightToes}) {
      const JointIndex joint = skeleton.jointOf(bone);
      if (joint == kNoJoint) continue;
      tposeFromJoint_[index(joint)] = rig_.toesHeading[side].conjugate() * tposeFromJoint_[index(joint)];
    }
  }
}

void HumanRig::evaluate(std::span<const JointTransform> pose) {
  evaluatePose(rig_.skeleton, pose, worldRotation_, worldFromJoint_);
}

Vec3 HumanRig::positionOf(HumanBone bone) const {
  return worldFromJoint_[index(rig_.skeleton.jointOf(bone))].translation();
}

Vec3 HumanRig::middleHip() const {
  return 0.5 * (positionOf(HumanBone::kLeftUpperLeg) + positionOf(HumanBone::kRightUpperLeg));
}

FootPosition HumanRig::footPosition(std::size_t side) const {
  const Affine3& foot = worldFromJoint_[index(rig_.skeleton.jointOf(limbs()[kFirstLeg + side].end))];
  const JointIndex toesJoint = rig_.skeleton.jointOf(side == 0 ? HumanBone::kLeftToes : HumanBone::kRightToes);
  const Affine3& toes = toesJoint == kNoJoint ? foot : worldFromJoint_[index(toesJoint)];
  const RetargetRig::Sole& sole = rig_.sole[side];
  FootPosition position;
  position.ankle = foot.translation();
  position.ball = foot * sole.ball;
  position.lowest = std::min({(foot * sole.heel).y(), position.ball.y(), (toes * sole.tip).y()});
  return position;
}

HumanPose HumanRig::read(std::span<const JointTransform> pose) {
  evaluate(pose);
  HumanPose human;
  const auto turnOf = [&](HumanBone bone) -> std::optional<Quat>& {
    return human.turn[static_cast<std::size_t>(bone)];
  };
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const std::optional<HumanBone> bone = rig_.skeleton.joint(static_cast<JointIndex>(j)).bone;
    if (bone) turnOf(*bone) = (worldRotation_[j] * tposeFromJoint_[j].conjugate()).normalized();
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
  for (std::size_t side = 0; side < 2; ++side) human.foot[side] = footPosition(side);
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
  const Skeleton& skeleton = rig_.skeleton;
  LORICA_CHECK(pose.size() == skeleton.joints().size() && !spineTurns.empty(), "the pose must match the skeleton");
  const auto spineTurn = [&](std::size_t i) {
    const double along = static_cast<double>(i * (spineTurns.size() - 1)) / static_cast<double>(spine_.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(along), spineTurns.size() - 1);
    const std::size_t above = std::min(below + 1, spineTurns.size() - 1);
    return spineTurns[below].slerp(along - static_cast<double>(below), spineTurns[above]);
  };
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const Joint& joint = skeleton.joint(static_cast<JointIndex>(j));
    const Quat above = joint.parent == kNoJoint ? Quat::Identity() : worldRotation_[index(joint.parent)];
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
    worldRotation_[j] = (above * pose[j].rotation).normalized();
  }
  computeWorldFromJoint(skeleton, pose, worldFromJoint_);
}

void HumanRig::reach(std::size_t side, const Vec3& ankle, std::span<JointTransform> pose) {
  bendLeg(rig_, side, ankle, worldRotation_, worldFromJoint_, pose);
  evaluate(pose);
}

void HumanRig::move(const Vec3& by, std::span<JointTransform> pose) {
  pose[index(rig_.hips)].translation += rig_.hipsParentFromWorld.linear() * by;
  evaluate(pose);
}

}  // namespace lorica
