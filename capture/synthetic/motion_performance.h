#pragma once

#include "capture/synthetic/motion_feet.h"
#include "capture/synthetic/motion_rig.h"
#include "capture/synthetic/motion_track.h"

#include <cstdint>
#include <vector>

namespace lorica::motion {

/// A channel of arm poses: a pose for each time [s].
using ArmCurve = std::function<ArmPose(double)>;

/// The hand at a time, in the form that reach() accepts.
struct ArmKey {
  double time;
  Vec3 hand;
  Vec3 elbowPole;
  double twist = 0.0;
  double bend = 0.0;
};

/// An arm through keys: upper arm, elbow and hand each on smooth curves.
[[nodiscard]] ArmCurve armThrough(const std::vector<ArmKey>& keys);

/// A choreography: every channel of the figure over time. Angles in radians, lengths in metres, world frame.
struct Performance {
  double duration = 10.0;
  std::uint64_t seed = 1;  ///< for breathing and sway
  FootPath leftFoot, rightFoot;
  Curve heading = Track(0.0);  ///< yaw of the pelvis
  Curve pelvisPitch = Track(0.0);
  Curve pelvisRoll = Track(0.0);
  Curve height = Track(0.917);           ///< of the pelvis, or of the centre of mass
  bool heightIsCentreOfMass = false;     ///< for jumps: then the flight can be a parabola
  Curve x = Track(0.0), z = Track(0.0);  ///< of the centre of mass, or of the pelvis
  bool groundIsCentreOfMass = true;      ///< keeps balance: the pelvis is placed where the weight of the limbs requires
                                         ///< it
  Curve chestPitch = Track(0.03);        ///< relative to the pelvis
  Curve chestRoll = Track(0.0);
  Curve chestTwist = Track(0.0);
  Curve headYaw = Track(0.0);  ///< the head is controlled in the world frame: people keep their gaze still
  Curve headPitch = Track(0.0);
  Curve headRoll = Track(0.0);
  ArmCurve leftArm, rightArm;
  Curve kneesOut = Track(0.08);
  double liveliness = 1.0;  ///< scales sway
};

/// The figure at a time, with the pelvis lowered by `drop` [m] from `height`.
[[nodiscard]] SkeletonFrame performAt(const Performance& performance, double time, double drop = 0.0);

/// All frames at 30 Hz. The pelvis is lowered smoothly wherever a planted foot would be out of reach.
[[nodiscard]] std::vector<SkeletonFrame> perform(const Performance& performance);

}  // namespace lorica::motion
