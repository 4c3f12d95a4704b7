#pragma once

#include "capture/retarget/retarget_rig.h"

#include <array>
#include <span>

namespace lorica {

/// A tracked foot in one frame.
struct TrackedFoot {
  bool seen = false;          ///< with the leg above it
  Vec3 place = Vec3::Zero();  ///< of the ankle, in the person's world [m]
  double above = 0.0;         ///< the ankle's height over where it is when the person stands [m]
};

/// Keeps a character's feet where they stand while the person's do, frame by frame and without looking ahead.
///
/// A foot locks when it is low and slow, and stays locked until it is neither (bounds in the source, hysteresis between
/// them). Its anchor moves by what the person's foot moves, scaled: so the anchor of a foot that stands still stands
/// still, whatever the character's proportions. The root goes along with what the locked feet ask for in the mean, so
/// that legs go on pointing as the person's; what is then left of more than 5 mm is bent away in hip and knee. When a
/// leg is too short the root comes down. A foot that lifts off loses what was added to its place within a few tenths of
/// a second. A leg that was lost is left alone until it has come back to where it is seen. Nothing jumps, and nothing
/// is allocated.
class FootLock {
 public:
  /// Moves the legs of a pose, and its root where a leg is too short.
  /// @param ratio          the character's leg length over the person's
  /// @param step           since the frame before [s]; 0 in the first
  /// @param worldRotation  of the pose's joints, without scale; kept up to date
  /// @param worldFromJoint of the pose's joints; kept up to date
  /// @param pose           jointCount local transforms, changed
  void apply(const RetargetRig& rig, const std::array<TrackedFoot, 2>& feet, double ratio, double step,
             std::span<Quat> worldRotation, std::span<Affine3> worldFromJoint, std::span<JointTransform> pose);

 private:
  struct Foot {
    bool locked = false;
    double unsettled = 0.0;        ///< a leg that was lost still comes back for so long [s]
    bool seen = false;             ///< in the frame before
    Vec3 place = Vec3::Zero();     ///< the person's, then
    Vec3 velocity = Vec3::Zero();  ///< the person's, smoothed [m/s]
    Vec3 anchor = Vec3::Zero();    ///< of the character's ankle while locked [m]
    Vec3 shown = Vec3::Zero();     ///< the character's ankle in the frame before
    bool hasShown = false;
    Vec3 correction = Vec3::Zero();  ///< added to the ankle's place [m]
  };
  static void follow(Foot& foot, const TrackedFoot& tracked, const Vec3& posed, double size, double ratio, double step);

  std::array<Foot, 2> feet_;
  Vec3 shift_ = Vec3::Zero();  ///< of the root, level [m]
  double nudge_ = 0.0;         ///< the root is down by this [m]
};

}  // namespace lorica
