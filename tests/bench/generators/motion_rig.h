#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/random_numbers.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// The figure used for the shipped motions: an adult of about 1.75 m as a chain of rigid bones.
namespace lorica::motion {

/// A channel of a motion over time [s].
using Curve = std::function<double(double)>;

[[nodiscard]] constexpr double degrees(double value) {
  return value * 3.14159265358979323846 / 180.0;
}

/// Position, velocity and acceleration of a curve at one time.
struct CurvePoint {
  double value = 0.0;
  double rate = 0.0;
  double acceleration = 0.0;
};

/// The quintic from `from` to `to` over `duration`; u in [0, 1] is the elapsed fraction.
[[nodiscard]] double quintic(const CurvePoint& from, const CurvePoint& to, double duration, double u);

/// 0 to 1 with no velocity or acceleration at either end (minimum jerk); clamped outside [0, 1].
[[nodiscard]] double minimumJerk(double u);

struct TrackKey {
  double time;
  double value;
  std::optional<double> rate = {};  ///< if omitted, chosen so that the curve never overshoots its keys
};

/// A curve through keys, continuous up to acceleration, constant before the first key and after the last.
///
/// Between rising keys it flows through; at a turning point it reverses like a sine; between equal keys it stays
/// constant.
class Track {
 public:
  Track(double constant = 0.0) : keys_{{constant, 0.0, 0.0}}, times_{0.0} {}
  /// @param keys  at least one, times strictly rising
  Track(std::vector<TrackKey> keys);
  Track(std::initializer_list<TrackKey> keys) : Track(std::vector<TrackKey>(keys)) {}

  double operator()(double time) const;

 private:
  std::vector<CurvePoint> keys_;
  std::vector<double> times_;
};

/// Slow, smooth, aperiodic wandering about zero, so that a standing person is not motionless.
class Wander {
 public:
  /// @param amplitude  approximate max excursion
  /// @param slowest, fastest  frequency range [Hz]
  Wander(std::uint64_t seed, double amplitude, double slowest, double fastest);
  double operator()(double time) const;

 private:
  struct Wave {
    double amplitude, frequency, phase;
  };
  std::vector<Wave> waves_;
};

// Lengths in T-pose [m]; hips at kAnkle + kThigh + kShin = 0.925.
inline constexpr double kHipHalfWidth = 0.09;
inline constexpr double kThigh = 0.42;
inline constexpr double kShin = 0.42;
inline constexpr double kLeg = kThigh + kShin;
inline constexpr double kAnkle = 0.085;      ///< height of the foot joint above the sole
inline constexpr double kHeelBehind = 0.05;  ///< of the foot joint, along the sole
inline constexpr double kBallAhead = 0.145;  ///< pivot of a rolling foot: between ball and toe tips, because toes bend
inline constexpr double kHipsToTorso = 0.25;
inline constexpr double kTorsoToNeck = 0.285;
inline constexpr double kNeckToHead = 0.165;
inline constexpr double kShoulderHalfWidth = 0.18;
inline constexpr double kShoulderDrop = 0.035;  ///< below the neck joint
inline constexpr double kUpperArm = 0.29;
inline constexpr double kForearm = 0.26;

enum Side { kLeft = 0, kRight = 1 };

/// An arm pose, always written for the left arm; the right one is its mirror image.
struct ArmPose {
  Vec3 swing = Vec3::Zero();  ///< rotation vector of the upper arm in the chest, zero in T-pose [rad]
  double elbow = 0.0;         ///< flexion [rad]
  double twist = 0.0;         ///< of the hand about the forearm; positive turns the palm down (pronation)
  double bend = 0.0;          ///< of the wrist toward the palm
};

struct FootPose {
  Vec3 ankle = Vec3::Zero();  ///< world [m]
  Quat rotation = Quat::Identity();
  bool planted = true;       ///< some part of the sole carries weight
  double follow = 0.0;       ///< 0: rotation is used; 1: the foot is attached to the shin instead
  double followPitch = 0.0;  ///< then its toes-down angle from perpendicular to the shin [rad]
};

/// All parameters that define a figure at one instant.
struct FigurePose {
  Vec3 pelvis = Vec3(0.0, kAnkle + kLeg, 0.0);  ///< midway between the hips, world [m]
  Quat worldFromPelvis = Quat::Identity();
  Quat pelvisFromChest = Quat::Identity();
  Quat worldFromHead = Quat::Identity();
  double shrug = 0.0;  ///< lift of both shoulders in addition to that of the arms [rad]
  std::array<ArmPose, 2> arms;
  std::array<FootPose, 2> feet;
  std::array<double, 2> kneeOut{};  ///< turns the knees outward [rad]
};

/// Rotation by angles about Y, X and Z, applied as Ry * Rx * Rz: turn left, bend forward, lean right.
[[nodiscard]] Quat turned(double yaw, double pitch, double roll);

/// The arm pose whose hand reaches a point.
/// @param hand       from the shoulder, in the chest frame of a left arm [m]; pulled in if the arm is too short
/// @param elbowPole  direction of the elbow, not parallel to hand
[[nodiscard]] ArmPose reach(const Vec3& hand, const Vec3& elbowPole);

/// The arm pose from angles [rad]: swung forward and out from hanging straight.
[[nodiscard]] ArmPose swungArm(double forward, double out, double elbow);

/// Forward kinematics of trunk and arms, two-bone inverse kinematics of the legs. Every confidence is 1. A planted foot
/// out of reach is pulled in, so that bones keep their length; clips must avoid this.
[[nodiscard]] SkeletonFrame solve(const FigurePose& pose, double time);

/// Centre of mass with the segment masses of an average adult (Winter, Biomechanics and Motor Control, table 4.1).
[[nodiscard]] Vec3 centreOfMass(const SkeletonFrame& frame);

}  // namespace lorica::motion
