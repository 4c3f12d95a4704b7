#include "skinning/mannequin/mannequin_skeleton.h"

#include "geometry/counts.h"

#include <array>

namespace lorica {

namespace {

using enum HumanBone;

struct Placement {
  HumanBone bone;
  HumanBone parent;
  double x, y, z;  ///< of the joint in T-pose [m]
};

// Parents first. Lengths follow an adult of 1.75 m: thigh 0.43, shin 0.40, upper arm 0.28, forearm 0.245, hand 0.19.
constexpr Placement kPlacements[] = {
    {kHips, kHips, 0.0, 0.950, -0.010},
    {kSpine, kHips, 0.0, 1.040, -0.015},
    {kChest, kSpine, 0.0, 1.150, -0.020},
    {kUpperChest, kChest, 0.0, 1.280, -0.025},
    {kNeck, kUpperChest, 0.0, 1.475, -0.030},
    {kHead, kNeck, 0.0, 1.560, -0.012},

    {kLeftUpperLeg, kHips, 0.092, 0.915, -0.008},
    {kLeftLowerLeg, kLeftUpperLeg, 0.097, 0.490, -0.002},
    {kLeftFoot, kLeftLowerLeg, 0.099, 0.090, -0.035},
    {kLeftToes, kLeftFoot, 0.107, 0.022, 0.098},

    {kLeftShoulder, kUpperChest, 0.030, 1.435, -0.010},
    {kLeftUpperArm, kLeftShoulder, 0.1720, 1.4110, -0.0180},
    {kLeftLowerArm, kLeftUpperArm, 0.4550, 1.4090, -0.0220},
    {kLeftHand, kLeftLowerArm, 0.6970, 1.4080, -0.0150},

    {kLeftThumbMetacarpal, kLeftHand, 0.7200, 1.4000, 0.0100},
    {kLeftThumbProximal, kLeftThumbMetacarpal, 0.7510, 1.3940, 0.0490},
    {kLeftThumbDistal, kLeftThumbProximal, 0.7710, 1.3910, 0.0740},
    {kLeftIndexProximal, kLeftHand, 0.7860, 1.4070, 0.0168},
    {kLeftIndexIntermediate, kLeftIndexProximal, 0.8278, 1.4058, 0.0203},
    {kLeftIndexDistal, kLeftIndexIntermediate, 0.8527, 1.4051, 0.0224},
    {kLeftMiddleProximal, kLeftHand, 0.7900, 1.4080, -0.0035},
    {kLeftMiddleIntermediate, kLeftMiddleProximal, 0.8360, 1.4068, -0.0035},
    {kLeftMiddleDistal, kLeftMiddleIntermediate, 0.8650, 1.4060, -0.0035},
    {kLeftRingProximal, kLeftHand, 0.7860, 1.4070, -0.0235},
    {kLeftRingIntermediate, kLeftRingProximal, 0.8278, 1.4058, -0.0270},
    {kLeftRingDistal, kLeftRingIntermediate, 0.8547, 1.4050, -0.0292},
    {kLeftLittleProximal, kLeftHand, 0.7740, 1.4040, -0.0430},
    {kLeftLittleIntermediate, kLeftLittleProximal, 0.8064, 1.4028, -0.0491},
    {kLeftLittleDistal, kLeftLittleIntermediate, 0.8261, 1.4021, -0.0528},
};

/// The first and the last bone of each limb on the left, and the first on the right, where they have the same order.
constexpr std::array<std::array<HumanBone, 3>, 3> kLimbs = {
    {{kLeftUpperLeg, kLeftToes, kRightUpperLeg},
     {kLeftShoulder, kLeftHand, kRightShoulder},
     {kLeftThumbMetacarpal, kLeftLittleDistal, kRightThumbMetacarpal}}};

}  // namespace

HumanBone mirrored(HumanBone bone) {
  const auto own = static_cast<int>(bone);
  for (const auto& [left, lastLeft, right] : kLimbs) {
    const int first = static_cast<int>(left), last = static_cast<int>(lastLeft),
              apart = static_cast<int>(right) - first;
    if (own >= first && own <= last) return static_cast<HumanBone>(own + apart);
    if (own - apart >= first && own - apart <= last) return static_cast<HumanBone>(own - apart);
  }
  return bone;
}

Vec3 mannequinJoint(HumanBone bone) {
  for (const Placement& p : kPlacements) {
    if (p.bone == bone) return {p.x, p.y, p.z};
    if (mirrored(p.bone) == bone) return {-p.x, p.y, p.z};
  }
  LORICA_CHECK(false, "every human bone has a placement");
  return Vec3::Zero();
}

Skeleton makeMannequinSkeleton() {
  std::vector<Joint> joints;
  std::array<JointIndex, kHumanBoneCount> indexOfBone{};
  const auto add = [&](HumanBone bone, HumanBone parent) {
    Joint joint;
    joint.name = nameOf(bone);
    joint.bone = bone;
    joint.rest.translation = mannequinJoint(bone);
    if (bone != parent) {
      joint.parent = indexOfBone[ordinalOf(parent)];
      joint.rest.translation -= mannequinJoint(parent);
    }
    indexOfBone[ordinalOf(bone)] = countOf(joints);
    joints.push_back(std::move(joint));
  };
  for (const Placement& p : kPlacements) add(p.bone, p.parent);
  for (const Placement& p : kPlacements) {
    if (mirrored(p.bone) != p.bone) add(mirrored(p.bone), mirrored(p.parent));
  }
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  LORICA_CHECK(skeleton.ok(), "the mannequin's bones are listed parents first");
  return std::move(*skeleton);
}

}  // namespace lorica
