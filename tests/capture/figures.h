#pragma once

#include "capture/skeleton_frame.h"
#include "skinning/skeleton.h"

#include <array>
#include <cstdint>
#include <vector>

/// Characters and people with known poses, to check retargeting against.
namespace lorica::test {

/// A character built in T-pose and then posed into a rest pose, optionally with arbitrary joint axes.
struct FigureSettings {
  double armsDown = 0.0;     ///< rest pose: arms lowered by this angle [rad]; 0 is a T-pose
  double elbowsBent = 0.0;   ///< rest pose: forearms forward by this angle [rad]
  double legsApart = 0.0;    ///< rest pose: each leg swung out by this angle [rad]
  double yaw = 0.0;          ///< rest pose: rotated to the left by this angle [rad]
  bool crookedAxes = false;  ///< a random world rotation for every joint's axes
  std::uint32_t seed = 1;
  double scale = 1.0;                                                 ///< of the whole figure
  double thigh = 0.42, shin = 0.40, upperArm = 0.29, forearm = 0.26;  ///< [m] before scale
  double toesAhead = 0.13;                                            ///< from the ankle [m] before scale
  bool armature = false;                                              ///< under a root joint in centimetres with Z up
  bool fullSpine = true;  ///< spine, chest, upperChest, clavicles and toes; else spine only
};

struct Figure {
  Skeleton skeleton;
  std::vector<Quat> tposeRotation;  ///< world rotation of each joint in T-pose, facing +Z
};
[[nodiscard]] Figure makeFigure(const FigureSettings& settings);

/// A person's pose as worldFromLimb orientations, identity in T-pose, with the position of the middle of the hips.
struct PersonPose {
  Vec3 middleHip = Vec3(0.0, 0.9, 0.0);
  Quat hips = Quat::Identity();
  Quat chest = Quat::Identity();
  Quat neck = Quat::Identity();
  Quat head = Quat::Identity();
  /// left arm, right arm, left leg, right leg
  std::array<Quat, 4> upper = {Quat::Identity(), Quat::Identity(), Quat::Identity(), Quat::Identity()};
  std::array<Quat, 4> lower = upper;
  std::array<Quat, 4> end = upper;
};

/// Joints of a person with 0.82 m legs by forward kinematics, every confidence 1.
[[nodiscard]] SkeletonFrame makeFrame(const PersonPose& pose, double time, bool withOrientations);

/// A random humanly possible pose: trunk bent, arms anywhere in front and to the side, elbows and knees folded in their
/// natural direction.
[[nodiscard]] PersonPose randomPose(std::uint32_t seed);

/// The joints that a tracker would report for a character in its rest pose, without orientations.
[[nodiscard]] SkeletonFrame frameOfRestPose(const Skeleton& skeleton);

/// World transforms of a pose.
[[nodiscard]] std::vector<Affine3> worldOf(const Skeleton& skeleton, const Pose& pose);

/// Angle between two directions [rad].
[[nodiscard]] double angleBetween(const Vec3& a, const Vec3& b);

[[nodiscard]] constexpr double degrees(double d) {
  return d * 0.017453292519943295;
}

}  // namespace lorica::test
