#include "capture/virtual_sensor/virtual_performer.h"

#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/retarget.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/errors.h"
#include "skinning/linear_blend.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

using B = HumanBone;
using J = BodyJoint;

/// The bone whose joint position is used for a tracked joint; the torso has none.
constexpr std::array<std::optional<B>, kBodyJointCount> kBoneOfJoint = {
    B::kHead,          B::kNeck,         B::kLeftUpperArm,  B::kRightUpperArm, B::kLeftLowerArm,
    B::kRightLowerArm, B::kLeftHand,     B::kRightHand,     std::nullopt,      B::kLeftUpperLeg,
    B::kRightUpperLeg, B::kLeftLowerLeg, B::kRightLowerLeg, B::kLeftFoot,      B::kRightFoot};

bool sameNames(const Skeleton& a, const Skeleton& b) {
  return std::equal(a.joints().begin(), a.joints().end(), b.joints().begin(), b.joints().end(),
                    [](const Joint& p, const Joint& q) { return p.name == q.name; });
}

}  // namespace

Result<VirtualPerformer> VirtualPerformer::create(Character character, std::span<const SkeletonFrame> recording) {
  if (recording.empty()) return invalidArgument("found no joint frames, expected at least one");
  LORICA_TRY_DO(checkCharacter(character));
  LORICA_TRY(ProxySkeleton proxy, ProxySkeleton::create(character));
  LORICA_TRY(Retargeter retargeter, Retargeter::create(proxy.skeleton()));
  SkeletalMotion motion{"", proxy.skeleton(), {}, {}};
  Pose pose = restPose(motion.skeleton);
  motion.times.reserve(recording.size());
  motion.poses.reserve(recording.size() * pose.size());
  for (const SkeletonFrame& frame : recording) {
    retargeter.apply(frame, pose);
    motion.times.push_back(frame.time);
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  motion = proxy.mapBack(std::move(motion));
  return VirtualPerformer(std::move(character), std::move(motion));
}

Result<VirtualPerformer> VirtualPerformer::create(Character character, const SkeletalMotion& motion) {
  if (motion.times.empty() || motion.poses.size() != motion.times.size() * motion.skeleton.joints().size()) {
    return invalidArgument("the motion has no frames, or frames without one transform per joint");
  }
  LORICA_TRY_DO(checkCharacter(character));
  if (sameNames(motion.skeleton, character.skeleton)) {
    LORICA_TRY(SkeletalMotion own, retargetByJointNames(motion, character.skeleton));
    return VirtualPerformer(std::move(character), std::move(own));
  }
  LORICA_TRY(ProxySkeleton proxy, ProxySkeleton::create(character));
  LORICA_TRY(SkeletalMotion carried, retargetMotion(motion, proxy.skeleton()));
  SkeletalMotion own = proxy.mapBack(std::move(carried));
  return VirtualPerformer(std::move(character), std::move(own));
}

VirtualPerformer::VirtualPerformer(Character character, SkeletalMotion motion)
    : character_(std::move(character)),
      motion_(std::move(motion)),
      sides_(openEdgeCount({character_.mesh.vertices, {triangles().begin(), triangles().end()}}) == 0
                 ? SurfaceSides::kOuter
                 : SurfaceSides::kBoth),
      pose_(restPose(character_.skeleton)),
      targetFromJoint_(pose_.size()),
      targetFromModel_(pose_.size()),
      positions_(character_.mesh.vertices.size()) {
  // Orientations require reading the whole body; this is done once here, and the result is interpolated later.
  if (const Result<std::vector<SkeletonFrame>> frames = bodyJointsOf(motion_); frames) {
    orientations_.resize(frames->size());
    for (std::size_t f = 0; f < frames->size(); ++f) {
      for (std::size_t j = 0; j < kBodyJointCount; ++j) orientations_[f][j] = (*frames)[f].joints[j].orientation;
    }
  }
  pose(0.0, Isometry3::Identity());
}

void VirtualPerformer::pose(double time, const Isometry3& targetFromWorld) {
  // The frames before and after the time.
  const double wanted = std::clamp(motion_.times.front() + time, motion_.times.front(), motion_.times.back());
  const auto after = std::upper_bound(motion_.times.begin(), motion_.times.end(), wanted);
  const std::size_t last = motion_.frameCount() - 1;
  const std::size_t to = std::min(static_cast<std::size_t>(after - motion_.times.begin()), last);
  const std::size_t from = to > 0 ? to - 1 : 0;
  const double span = motion_.times[to] - motion_.times[from];
  const double part = span > 0.0 ? std::clamp((wanted - motion_.times[from]) / span, 0.0, 1.0) : 1.0;
  const std::span<const JointTransform> fromPose = motion_.pose(from);
  const std::span<const JointTransform> toPose = motion_.pose(to);
  for (std::size_t j = 0; j < pose_.size(); ++j) {
    pose_[j].translation = (1.0 - part) * fromPose[j].translation + part * toPose[j].translation;
    pose_[j].rotation = fromPose[j].rotation.slerp(part, toPose[j].rotation);
    pose_[j].scale = (1.0 - part) * fromPose[j].scale + part * toPose[j].scale;
  }

  computeWorldFromJoint(character_.skeleton, pose_, targetFromJoint_);
  for (Affine3& joint : targetFromJoint_) joint = targetFromWorld * joint;
  computeWorldFromModel(character_, targetFromJoint_, targetFromModel_);
  skinLinearBlend(character_, targetFromModel_, positions_);

  const auto position = [&](B bone) -> std::optional<Vec3> {
    const JointIndex joint = character_.skeleton.jointOf(bone);
    if (joint == kNoJoint) return std::nullopt;
    return Vec3(targetFromJoint_[joint].translation());
  };
  joints_ = {};
  joints_.time = time;
  const Quat targetTurn(targetFromWorld.linear());
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    TrackedJoint& joint = joints_.joints[j];
    std::optional<Vec3> at;
    if (kBoneOfJoint[j]) {
      at = position(*kBoneOfJoint[j]);
    } else {
      const std::optional<Vec3> left = position(B::kLeftUpperLeg);
      const std::optional<Vec3> right = position(B::kRightUpperLeg);
      std::optional<Vec3> neck = position(B::kNeck);
      if (!neck && position(B::kLeftUpperArm) && position(B::kRightUpperArm)) {
        neck = 0.5 * (*position(B::kLeftUpperArm) + *position(B::kRightUpperArm));
      }
      if (left && right && neck) at = 0.25 * (*left + *right) + 0.5 * *neck;
    }
    if (!at) continue;
    joint.position = *at;
    joint.confidence = 1.0;
    if (orientations_.empty() || !orientations_[from][j] || !orientations_[to][j]) continue;
    joint.orientation = targetTurn * orientations_[from][j]->slerp(part, *orientations_[to][j]);
  }
}

}  // namespace lorica
