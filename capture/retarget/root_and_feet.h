#pragma once

#include "capture/retarget/retarget_rig.h"

#include <array>
#include <span>
#include <vector>

namespace lorica {

/// Foot state of a body at one time.
struct FootPosition {
  Vec3 ankle = Vec3::Zero();  ///< world [m]
  Vec3 ball = Vec3::Zero();   ///< of the sole, below the toe joint
  double lowest = 0.0;        ///< height of the lowest point of the sole [m]
};

/// A character in a pose: where its hips and feet are, and how they are moved. All retargeters hold one. Allocates
/// nothing but itself.
struct PosedBody {
  explicit PosedBody(RetargetRig rig);  ///< in the rest pose

  RetargetRig rig;                      ///< of the character
  std::vector<Quat> worldRotation;      ///< one per joint, without scale
  std::vector<Affine3> worldFromJoint;  ///< one per joint

  /// Computes the two from a pose.
  void evaluate(std::span<const JointTransform> pose);
  /// World [m]; the bone exists.
  [[nodiscard]] Vec3 positionOf(HumanBone bone) const;
  /// Between both thighs' joints, world [m].
  [[nodiscard]] Vec3 middleHip() const;
  /// @param side  0 = left, 1 = right; world [m].
  [[nodiscard]] FootPosition foot(int side) const;

  /// Translates the pose of the hips. @param by  world [m]
  void moveHips(const Vec3& by, std::span<JointTransform> pose) const;
  /// Moves an ankle to a position by bending the leg; the foot keeps its world rotation. Several legs may be bent, with
  /// known target positions, before the pose is evaluated again.
  void bendLeg(int side, const Vec3& ankle, std::span<JointTransform> pose) const;
};

/// The middle of the hips on a path that starts where another body's does and is scaled by the ratio of leg lengths,
/// over a floor at y = 0. @param floor  under the other body [m]
[[nodiscard]] Vec3 scaledPath(const Vec3& start, const Vec3& hip, double ratio, double floor);

/// A tracked foot in one frame.
struct TrackedFoot {
  bool seen = false;             ///< together with the leg above it
  Vec3 position = Vec3::Zero();  ///< of the ankle, in the person's world [m]
  double above = 0.0;            ///< ankle height relative to its height when the person stands [m]
};

/// Keeps a character's feet in place while the person's feet stand still, frame by frame without lookahead.
///
/// A foot locks when it is low and slow, and stays locked until it is no longer both (limits in the source, with
/// hysteresis). The lock's anchor moves with the scaled motion of the person's foot: for a foot that stands still the
/// anchor stands still, whatever the character's proportions. The root follows the mean correction of the locked feet,
/// so that legs keep the direction of the person's; a remaining error above 5 mm is removed by bending hip and knee. If
/// a leg is too short, the root is lowered. After lift-off a foot's correction decays within a few tenths of a second.
/// A leg that was lost is left alone until it has returned to its tracked position. The result has no jumps; allocates
/// nothing.
class FootLock {
 public:
  /// Adjusts the legs of a pose, and its root if a leg is too short.
  /// @param ratio the character's leg length over the person's
  /// @param step  time since the previous frame [s]; 0 in the first
  /// @param body  of the pose, updated
  /// @param pose  jointCount local transforms, updated
  void apply(PosedBody& body, const std::array<TrackedFoot, 2>& feet, double ratio, double step,
             std::span<JointTransform> pose);

 private:
  struct Foot {
    bool locked = false;
    double unsettled = 0.0;        ///< remaining time in which a lost leg is still returning [s]
    bool seen = false;             ///< in the previous frame
    Vec3 position = Vec3::Zero();  ///< the person's foot, in the previous frame
    Vec3 velocity = Vec3::Zero();  ///< the person's foot, smoothed [m/s]
    Vec3 anchor = Vec3::Zero();    ///< of the character's ankle while locked [m]
    Vec3 shown = Vec3::Zero();     ///< the character's ankle in the previous frame
    bool hasShown = false;
    Vec3 correction = Vec3::Zero();  ///< added to the ankle position [m]
  };
  static void follow(Foot& foot, const TrackedFoot& tracked, const Vec3& posed, double size, double ratio, double step);

  std::array<Foot, 2> feet_;
  Vec3 shift_ = Vec3::Zero();  ///< of the root, horizontal [m]
  double nudge_ = 0.0;         ///< amount by which the root is lowered [m]
};

}  // namespace lorica
