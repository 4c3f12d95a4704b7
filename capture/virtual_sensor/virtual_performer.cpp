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

/// A stretched bone, and the bone at its end.
struct Stretch {
  B bone, end;
  double BodyProportions::*along;
};
constexpr std::array kStretches = {Stretch{B::kLeftUpperArm, B::kLeftLowerArm, &BodyProportions::arms},
                                   Stretch{B::kRightUpperArm, B::kRightLowerArm, &BodyProportions::arms},
                                   Stretch{B::kLeftLowerArm, B::kLeftHand, &BodyProportions::arms},
                                   Stretch{B::kRightLowerArm, B::kRightHand, &BodyProportions::arms},
                                   Stretch{B::kLeftUpperLeg, B::kLeftLowerLeg, &BodyProportions::legs},
                                   Stretch{B::kRightUpperLeg, B::kRightLowerLeg, &BodyProportions::legs},
                                   Stretch{B::kLeftLowerLeg, B::kLeftFoot, &BodyProportions::legs},
                                   Stretch{B::kRightLowerLeg, B::kRightFoot, &BodyProportions::legs}};
/// From the hips up; each ends at the next existing one.
constexpr std::array kTrunk = {B::kHips, B::kSpine, B::kChest, B::kUpperChest, B::kNeck};

/// Change of one joint's part of the mesh: `whole` is applied around the joint. Child joints move by `lengths` only.
struct Change {
  Mat3 lengths = Mat3::Identity();      ///< model axes
  Mat3 whole = Mat3::Identity();        ///< model axes
  Mat3 restLengths = Mat3::Identity();  ///< the joint's own axes
};

Mat3 along(const Vec3& axis, double lengthwise, double across) {
  return across * Mat3::Identity() + (lengthwise - across) * axis * axis.transpose();
}

/// Position of a descendant joint relative to a joint at rest.
Vec3 restPosition(const Skeleton& skeleton, JointIndex joint, JointIndex below) {
  Vec3 position = Vec3::Zero();
  for (JointIndex j = below; j != joint && j != kNoJoint; j = skeleton.joint(j).parent) {
    position = skeleton.joint(j).rest.matrix() * position;
  }
  return position;
}

double lowestOf(const TriMesh& mesh) {
  double lowest = mesh.vertices.empty() ? 0.0 : mesh.vertices.front().y();
  for (const Vec3& v : mesh.vertices) lowest = std::min(lowest, v.y());
  return lowest;
}

bool sameNames(const Skeleton& a, const Skeleton& b) {
  return std::equal(a.joints().begin(), a.joints().end(), b.joints().begin(), b.joints().end(),
                    [](const Joint& p, const Joint& q) { return p.name == q.name; });
}

}  // namespace

Character withProportions(const Character& character, const BodyProportions& proportions) {
  const Skeleton& skeleton = character.skeleton;
  const std::size_t jointCount = skeleton.jointCount();
  std::vector<Affine3> modelFromJoint(jointCount);
  for (std::size_t j = 0; j < jointCount; ++j) modelFromJoint[j] = character.jointFromModel[j].inverse();

  std::vector<Change> changes(jointCount);
  const auto change = [&](B bone, B end, double lengthwise) {
    const JointIndex joint = skeleton.jointOf(bone);
    const JointIndex tip = skeleton.jointOf(end);
    if (joint == kNoJoint || tip == kNoJoint) return;
    const Vec3 axis = modelFromJoint[tip].translation() - modelFromJoint[joint].translation();
    const Vec3 restAxis = restPosition(skeleton, joint, tip);
    if (axis.norm() < 1e-6 || restAxis.norm() < 1e-9) return;
    Change& made = changes[joint];
    made.lengths = along(axis.normalized(), lengthwise, 1.0);
    made.whole = along(axis.normalized(), lengthwise, proportions.girth);
    made.restLengths = along(restAxis.normalized(), lengthwise, 1.0);
  };
  for (const Stretch& stretch : kStretches) change(stretch.bone, stretch.end, proportions.*stretch.along);
  for (std::size_t from = 0; from + 1 < kTrunk.size(); ++from) {
    std::size_t to = from + 1;
    while (to + 1 < kTrunk.size() && skeleton.jointOf(kTrunk[to]) == kNoJoint) ++to;
    change(kTrunk[from], kTrunk[to], proportions.trunk);
  }

  // Parents precede children: each joint moves with its parent's change. If the bind pose is a pose of the skeleton,
  // the changed bind pose is a pose of the changed skeleton.
  std::vector<Vec3> position(jointCount);
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  for (std::size_t j = 0; j < jointCount; ++j) {
    const JointIndex parent = joints[j].parent;
    position[j] = modelFromJoint[j].translation();
    if (parent == kNoJoint) continue;
    const std::size_t p = parent;
    position[j] = position[p] + changes[p].lengths * (position[j] - modelFromJoint[p].translation());
    joints[j].rest.translation = changes[p].restLengths * joints[j].rest.translation;
  }

  Character changed = character;
  for (std::size_t v = 0; v < changed.mesh.vertices.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      const std::size_t j = character.influences[i].joint;
      const Vec3 from = character.mesh.vertices[v] - modelFromJoint[j].translation();
      sum += character.influences[i].weight * (position[j] + changes[j].whole * from);
    }
    changed.mesh.vertices[v] = sum;
  }

  const Vec3 lift(0.0, lowestOf(character.mesh) - lowestOf(changed.mesh), 0.0);
  for (Vec3& v : changed.mesh.vertices) v = proportions.height * (v + lift);
  for (std::size_t j = 0; j < jointCount; ++j) {
    modelFromJoint[j].translation() = proportions.height * (position[j] + lift);
    changed.jointFromModel[j] = modelFromJoint[j].inverse();
    if (joints[j].parent == kNoJoint) joints[j].rest.translation += lift;
    joints[j].rest.translation *= proportions.height;
  }
  Result<Skeleton> made = Skeleton::create(std::move(joints));
  LORICA_CHECK(made.ok(), "the joint order must match the character's");
  changed.skeleton = std::move(*made);
  const Aabb bounds = boundsOf(changed.mesh.vertices);
  changed.height = bounds.empty() ? 0.0 : bounds.max.y() - bounds.min.y();
  return changed;
}

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
