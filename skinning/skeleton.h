#pragma once

#include "geometry/counts.h"
#include "geometry/math.h"
#include "geometry/result.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

using JointIndex = std::int32_t;            ///< of a skeleton, from 0; parents precede children
inline constexpr JointIndex kNoJoint = -1;  ///< no joint

/// The humanoid bones of VRM 1.0 (https://github.com/vrm-c/vrm-specification, humanoid.md), without eyes and jaw.
enum class HumanBone : std::uint8_t {
  kHips,
  kSpine,
  kChest,
  kUpperChest,
  kNeck,
  kHead,
  kLeftUpperLeg,
  kLeftLowerLeg,
  kLeftFoot,
  kLeftToes,
  kRightUpperLeg,
  kRightLowerLeg,
  kRightFoot,
  kRightToes,
  kLeftShoulder,
  kLeftUpperArm,
  kLeftLowerArm,
  kLeftHand,
  kRightShoulder,
  kRightUpperArm,
  kRightLowerArm,
  kRightHand,
  kLeftThumbMetacarpal,
  kLeftThumbProximal,
  kLeftThumbDistal,
  kLeftIndexProximal,
  kLeftIndexIntermediate,
  kLeftIndexDistal,
  kLeftMiddleProximal,
  kLeftMiddleIntermediate,
  kLeftMiddleDistal,
  kLeftRingProximal,
  kLeftRingIntermediate,
  kLeftRingDistal,
  kLeftLittleProximal,
  kLeftLittleIntermediate,
  kLeftLittleDistal,
  kRightThumbMetacarpal,
  kRightThumbProximal,
  kRightThumbDistal,
  kRightIndexProximal,
  kRightIndexIntermediate,
  kRightIndexDistal,
  kRightMiddleProximal,
  kRightMiddleIntermediate,
  kRightMiddleDistal,
  kRightRingProximal,
  kRightRingIntermediate,
  kRightRingDistal,
  kRightLittleProximal,
  kRightLittleIntermediate,
  kRightLittleDistal,
};
/// Bones that HumanBone names
inline constexpr int kHumanBoneCount = static_cast<int>(HumanBone::kRightLittleDistal) + 1;

/// VRM's name: "leftUpperArm".
[[nodiscard]] std::string_view nameOf(HumanBone bone);
/// The inverse of nameOf(); nothing for other names.
[[nodiscard]] std::optional<HumanBone> humanBoneNamed(std::string_view name);

/// Local transform of a joint, parentFromJoint: translation * rotation * scale.
struct JointTransform {
  Vec3 translation{0.0, 0.0, 0.0};    ///< [m]
  Quat rotation{1.0, 0.0, 0.0, 0.0};  ///< unit
  Vec3 scale{1.0, 1.0, 1.0};          ///< factors along its own axes

  [[nodiscard]] Affine3 matrix() const;  ///< parentFromJoint
};

/// A joint of a skeleton.
struct Joint {
  std::string name;               ///< in the file
  JointIndex parent = kNoJoint;   ///< precedes it; kNoJoint of a root
  JointTransform rest;            ///< parentFromJoint in the rest pose
  std::optional<HumanBone> bone;  ///< which human bone it is, if any
};

/// A hierarchy of at least one joint; parents precede children.
class Skeleton {
 public:
  /// @return the skeleton; or an error with the joint whose parent does not precede it, whose rest transform is
  ///         invalid, or whose bone another joint already has
  static Result<Skeleton> create(std::vector<Joint> joints);

  [[nodiscard]] std::span<const Joint> joints() const { return joints_; }      ///< parents precede children
  [[nodiscard]] int jointCount() const { return countOf(joints_); }            ///< of the whole skeleton
  [[nodiscard]] const Joint& joint(JointIndex i) const { return joints_[i]; }  ///< @param i  below jointCount()
  /// kNoJoint if the skeleton lacks the bone.
  [[nodiscard]] JointIndex jointOf(HumanBone bone) const { return jointOfBone_[ordinalOf(bone)]; }

 private:
  std::vector<Joint> joints_;
  std::array<JointIndex, kHumanBoneCount> jointOfBone_{};
};

/// One local transform for each joint of a skeleton.
using Pose = std::vector<JointTransform>;

/// Every joint as it rests.
[[nodiscard]] Pose restPose(const Skeleton& skeleton);

/// Forward kinematics. @param worldFromJoint  jointCount transforms, written
void computeWorldFromJoint(const Skeleton& skeleton, std::span<const JointTransform> pose,
                           std::span<Affine3> worldFromJoint);

}  // namespace lorica
