#include "skinning/skeleton.h"

#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {

namespace {

/// In the order of HumanBone.
constexpr std::array<std::string_view, kHumanBoneCount> kBoneNames = [] {
  std::string_view left =
      "hips spine chest upperChest neck head "
      "leftUpperLeg leftLowerLeg leftFoot leftToes rightUpperLeg rightLowerLeg rightFoot rightToes "
      "leftShoulder leftUpperArm leftLowerArm leftHand rightShoulder rightUpperArm rightLowerArm rightHand "
      "leftThumbMetacarpal leftThumbProximal leftThumbDistal "
      "leftIndexProximal leftIndexIntermediate leftIndexDistal "
      "leftMiddleProximal leftMiddleIntermediate leftMiddleDistal "
      "leftRingProximal leftRingIntermediate leftRingDistal "
      "leftLittleProximal leftLittleIntermediate leftLittleDistal "
      "rightThumbMetacarpal rightThumbProximal rightThumbDistal "
      "rightIndexProximal rightIndexIntermediate rightIndexDistal "
      "rightMiddleProximal rightMiddleIntermediate rightMiddleDistal "
      "rightRingProximal rightRingIntermediate rightRingDistal "
      "rightLittleProximal rightLittleIntermediate rightLittleDistal";
  std::array<std::string_view, kHumanBoneCount> names;
  for (std::string_view& name : names) {
    name = left.substr(0, left.find(' '));
    left.remove_prefix(std::min(name.size() + 1, left.size()));
  }
  return names;
}();
static_assert(kBoneNames.back() == "rightLittleDistal");

[[nodiscard]] bool isFinite(const JointTransform& t) {
  return t.translation.allFinite() && t.rotation.coeffs().allFinite() && t.scale.allFinite();
}

}  // namespace

std::string_view nameOf(HumanBone bone) {
  const std::size_t i = ordinalOf(bone);
  LORICA_CHECK(i < kBoneNames.size(), "HumanBone is out of range");
  return kBoneNames[i];
}

std::optional<HumanBone> humanBoneNamed(std::string_view name) {
  const auto found = std::find(kBoneNames.begin(), kBoneNames.end(), name);
  if (found == kBoneNames.end()) return std::nullopt;
  return static_cast<HumanBone>(found - kBoneNames.begin());
}

Affine3 JointTransform::matrix() const {
  return Eigen::Translation3d(translation) * rotation * Eigen::Scaling(scale);
}

Result<Skeleton> Skeleton::create(std::vector<Joint> joints) {
  if (joints.empty()) return invalidArgument("the skeleton has no joints, expected at least one");

  Skeleton skeleton;
  skeleton.jointOfBone_.fill(kNoJoint);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Joint& joint = joints[i];
    if (joint.parent != kNoJoint && (joint.parent < 0 || std::cmp_greater_equal(joint.parent, i))) {
      return invalidArgument("joint {} '{}': its parent is joint {}, expected a preceding joint, or {} for a root", i,
                             joint.name, joint.parent, kNoJoint);
    }
    if (!isFinite(joint.rest)) {
      return invalidArgument("joint {} '{}': its rest transform is not finite", i, joint.name);
    }
    const double norm = joint.rest.rotation.norm();
    if (std::abs(norm - 1.0) > 1e-3) {
      return invalidArgument("joint {} '{}': its rest rotation has norm {}, expected 1 +- 0.001", i, joint.name, norm);
    }
    if (!joint.bone) continue;
    JointIndex& slot = skeleton.jointOfBone_[ordinalOf(*joint.bone)];
    if (slot != kNoJoint) {
      return invalidArgument("joints {} and {} '{}' are both the bone {}, expected one", slot, i, joint.name,
                             nameOf(*joint.bone));
    }
    slot = i;
  }
  skeleton.joints_ = std::move(joints);
  return skeleton;
}

Pose restPose(const Skeleton& skeleton) {
  Pose pose;
  pose.reserve(skeleton.joints().size());
  for (const Joint& joint : skeleton.joints()) pose.push_back(joint.rest);
  return pose;
}

void computeWorldFromJoint(const Skeleton& skeleton, std::span<const JointTransform> pose,
                           std::span<Affine3> worldFromJoint) {
  const std::span<const Joint> joints = skeleton.joints();
  LORICA_CHECK(pose.size() == joints.size(), "the pose belongs to another skeleton");
  LORICA_CHECK(worldFromJoint.size() == joints.size(), "worldFromJoint must have one element per joint");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Affine3 parentFromJoint = pose[i].matrix();
    const JointIndex parent = joints[i].parent;
    worldFromJoint[i] = parent == kNoJoint ? parentFromJoint : worldFromJoint[parent] * parentFromJoint;
  }
}

}  // namespace lorica
