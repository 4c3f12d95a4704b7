#include "capture/retarget/bone_pose.h"

#include "capture/retarget/human_rig.h"
#include "geometry/counts.h"
#include "skinning/humanoid/humanoid.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// Limbs of a T-pose may deviate this much [rad].
constexpr double kTposeTolerance = 0.44;

bool restsInTpose(const Skeleton& skeleton, std::span<const Affine3> worldFromJoint) {
  const auto at = [&](HumanBone bone) -> Vec3 { return worldFromJoint[skeleton.jointOf(bone)].translation(); };
  const auto along = [&](HumanBone from, HumanBone to, const Vec3& axis) {
    return (at(to) - at(from)).normalized().dot(axis) >= std::cos(kTposeTolerance);
  };
  return std::all_of(limbs().begin(), limbs().end(), [&](const LimbBones& limb) {
    return along(limb.upper, limb.lower, limb.axis) && along(limb.lower, limb.end, limb.axis);
  });
}

/// A position nearer to zero than this was not sent [m].
constexpr double kNowhere = 1e-6;

}  // namespace

BonePose mirrored(const BonePose& pose) {
  BonePose out;
  out.rootPosition = mirrored(pose.rootPosition);
  out.rootRotation = mirrored(pose.rootRotation);
  for (std::size_t b = 0; b < pose.rotation.size(); ++b) {
    const std::size_t other = ordinalOf(otherSide(static_cast<HumanBone>(b)));
    if (pose.rotation[other]) out.rotation[b] = mirrored(*pose.rotation[other]);
    out.offset[b] = mirrored(pose.offset[other]);
  }
  return out;
}

WorldBones worldOf(const BonePose& pose) {
  WorldBones world;
  for (std::size_t b = 0; b < world.turn.size(); ++b) {
    const std::optional<HumanBone> parent = parentBone(static_cast<HumanBone>(b));
    const Quat above = parent ? world.turn[ordinalOf(*parent)] : pose.rootRotation;
    const Vec3 from = parent ? world.position[ordinalOf(*parent)] : pose.rootPosition;
    world.turn[b] = pose.rotation[b] ? (above * *pose.rotation[b]).normalized() : above;
    world.position[b] = from + above * pose.offset[b];
  }
  return world;
}

std::vector<Quat> boneReference(const RetargetRig& rig) {
  const Skeleton& skeleton = rig.skeleton;
  const auto joints = static_cast<std::size_t>(skeleton.jointCount());
  std::vector<Quat> reference(joints, Quat::Identity());
  std::vector<Affine3> worldFromJoint(joints);
  std::vector<Quat> worldRotation(joints, Quat::Identity());
  evaluatePose(skeleton, restPose(skeleton), worldRotation, worldFromJoint);
  const std::vector<Quat>& source = restsInTpose(skeleton, worldFromJoint) ? worldRotation : rig.tposeFromJoint;
  for (std::size_t j = 0; j < joints; ++j) {
    if (skeleton.joint(static_cast<JointIndex>(j)).bone) reference[j] = source[j];
  }
  return reference;
}

Result<BonePoseReader> BonePoseReader::create(const Skeleton& skeleton) {
  MirroredAxes mirrored(skeleton);
  LORICA_TRY(RetargetRig rig, RetargetRig::create(mirrored.any() ? mirrored.straightened() : skeleton));
  return BonePoseReader(std::move(rig), std::move(mirrored));
}

BonePoseReader::BonePoseReader(RetargetRig rig, MirroredAxes mirrored)
    : body_(std::move(rig)), mirrored_(std::move(mirrored)), referenceFromJoint_(boneReference(body_.rig)) {
  if (mirrored_.any()) straight_ = restPose(body_.rig.skeleton);
  for (std::size_t b = 0; b < parent_.size(); ++b) {
    parent_[b] = parentBone(static_cast<HumanBone>(b));
    while (parent_[b] && body_.rig.skeleton.jointOf(*parent_[b]) == kNoJoint) parent_[b] = parentBone(*parent_[b]);
  }
}

BonePose BonePoseReader::read(std::span<const JointTransform> pose) {
  const Skeleton& skeleton = body_.rig.skeleton;
  if (mirrored_.any()) {
    straight_.assign(pose.begin(), pose.end());
    mirrored_.exchange(straight_);
    pose = straight_;
  }
  body_.evaluate(pose);
  const auto turnOf = [&](JointIndex joint) -> Quat {
    return body_.worldRotation[joint] * referenceFromJoint_[joint].conjugate();
  };
  BonePose out;
  for (std::size_t b = 0; b < out.rotation.size(); ++b) {
    const JointIndex joint = skeleton.jointOf(static_cast<HumanBone>(b));
    if (joint == kNoJoint) continue;
    const Vec3 position = body_.worldFromJoint[joint].translation();
    if (!parent_[b]) {
      out.rotation[b] = turnOf(joint).normalized();
      out.offset[b] = position;
      continue;
    }
    const JointIndex parent = skeleton.jointOf(*parent_[b]);
    const Quat parentFromWorld = turnOf(parent).conjugate();
    out.rotation[b] = (parentFromWorld * turnOf(joint)).normalized();
    out.offset[b] = parentFromWorld * (position - body_.worldFromJoint[parent].translation());
  }
  return out;
}

Result<SenderRest> SenderRest::create(const Skeleton& skeleton) {
  LORICA_TRY(const RetargetRig rig, RetargetRig::create(skeleton));
  const std::vector<Quat> reference = boneReference(rig);
  SenderRest out;
  for (std::size_t b = 0; b < out.bones_.size(); ++b) {
    const JointIndex joint = skeleton.jointOf(static_cast<HumanBone>(b));
    if (joint == kNoJoint) continue;
    // From the joint above up to the bone above, or to the world.
    Affine3 fromParent = Affine3::Identity();
    Quat turn = Quat::Identity();
    JointIndex above = skeleton.joint(joint).parent;
    while (above != kNoJoint && !skeleton.joint(above).bone) {
      const JointTransform& rest = skeleton.joint(above).rest;
      fromParent = rest.matrix() * fromParent;
      turn = rest.rotation * turn;
      above = skeleton.joint(above).parent;
    }
    const Quat bone = above == kNoJoint ? Quat::Identity() : reference[above];
    out.bones_[b] = Bone{(bone * turn).normalized(), bone * fromParent.translation(), reference[joint].conjugate(),
                         skeleton.joint(joint).rest.translation};
  }
  return out;
}

void SenderRest::apply(BonePose& pose) const {
  for (std::size_t b = 0; b < bones_.size(); ++b) {
    if (!bones_[b] || !pose.rotation[b]) continue;
    const Bone& bone = *bones_[b];
    const Vec3 sent = pose.offset[b].norm() > kNowhere ? pose.offset[b] : bone.rest;
    pose.offset[b] = bone.parentInReference + bone.referenceFromParent * sent;
    pose.rotation[b] = (bone.referenceFromParent * *pose.rotation[b] * bone.jointFromReference).normalized();
  }
}

}  // namespace lorica
