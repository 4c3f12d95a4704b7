#include "capture/retarget/mirrored_axes.h"

#include "capture/retarget/retarget_rig.h"
#include "skinning/humanoid/humanoid.h"

#include <utility>

namespace lorica {
namespace {

Vec3 signsOf(const Vec3& v) {
  return v.unaryExpr([](double x) { return x < 0.0 ? -1.0 : 1.0; });
}

/// Whether both feet point backwards by left and right.
bool facesBackwards(const Skeleton& skeleton) {
  std::vector<Affine3> world(skeleton.jointCount());
  computeWorldFromJoint(skeleton, restPose(skeleton), world);
  const auto way = [&](HumanBone from, HumanBone to) {
    const JointIndex a = skeleton.jointOf(from), b = skeleton.jointOf(to);
    return a == kNoJoint || b == kNoJoint ? Vec3(Vec3::Zero()) : Vec3(world[b].translation() - world[a].translation());
  };
  const Vec3 left = way(HumanBone::kRightUpperLeg, HumanBone::kLeftUpperLeg);
  const Vec3 ahead = left.cross(way(HumanBone::kHips, HumanBone::kHead));
  return way(HumanBone::kLeftFoot, HumanBone::kLeftToes).dot(ahead) < 0.0 &&
         way(HumanBone::kRightFoot, HumanBone::kRightToes).dot(ahead) < 0.0;
}

}  // namespace

MirroredAxes::MirroredAxes(const Skeleton& skeleton) : skeleton_(skeleton) {
  for (const Joint& joint : skeleton.joints()) {
    above_.push_back(joint.parent == kNoJoint ? Vec3(Vec3::Ones())
                                              : Vec3(above_[joint.parent].cwiseProduct(own_[joint.parent])));
    own_.push_back(signsOf(joint.rest.scale));
    any_ = any_ || own_.back().minCoeff() < 0.0;
  }
}

void MirroredAxes::exchange(std::span<JointTransform> pose) const {
  for (std::size_t j = 0; j < pose.size(); ++j) {
    // With the signs on the diagonal of D: D * translation, D * rotation * D.
    pose[j].translation = pose[j].translation.cwiseProduct(above_[j]);
    pose[j].rotation.vec() = pose[j].rotation.vec().cwiseProduct(above_[j].prod() * above_[j]);
    pose[j].scale = pose[j].scale.cwiseProduct(own_[j]);
  }
}

Skeleton MirroredAxes::straightened() const {
  Pose rest = restPose(skeleton_);
  exchange(rest);
  std::vector<Joint> joints(skeleton_.joints().begin(), skeleton_.joints().end());
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j].rest = rest[j];
  Skeleton straight = Skeleton::create(joints).value();
  if (!any_ || !facesBackwards(straight)) return straight;
  for (Joint& joint : joints) {
    if (joint.bone) joint.bone = otherSide(*joint.bone);
  }
  return Skeleton::create(std::move(joints)).value();
}

SkeletalMotion straightened(SkeletalMotion motion) {
  const MirroredAxes axes(motion.skeleton);
  if (!axes.any()) return motion;
  const std::size_t count = motion.skeleton.jointCount();
  for (std::size_t f = 0; f < motion.times.size(); ++f)
    axes.exchange(std::span(motion.poses).subspan(f * count, count));
  motion.skeleton = axes.straightened();
  return motion;
}

Character straightened(const Character& character) {
  const MirroredAxes axes(character.skeleton);
  Character straight = character;
  straight.skeleton = axes.straightened();
  for (std::size_t j = 0; j < straight.jointFromModel.size(); ++j) {
    straight.jointFromModel[j] = axes.below(static_cast<JointIndex>(j)).asDiagonal() * straight.jointFromModel[j];
  }
  return straight;
}

}  // namespace lorica
