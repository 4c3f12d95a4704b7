#pragma once

#include "geometry/math.h"
#include "geometry/result.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// The tracker's head joint as seen from the headset, until it is known better: as far below and behind the eyes as
/// that of the mannequin, which the tracker fits. A headset looks along its -Z, with +X to the right (OpenXR, WebXR).
inline const Vec3 kNominalHeadInHeadset{0.0, -0.1, 0.1};
inline constexpr double kLongestLag = 0.2;  ///< of a camera's joints behind the headset [s]

/// How the stage frame of a headset (Y up, y = 0 on the floor) lies to the floor frame of a depth camera's tracker.
struct Registration {
  double yaw = 0.0;                            ///< of stageFromFloor, about Y [rad]
  Vec3 translation = Vec3::Zero();             ///< of stageFromFloor [m]
  Vec3 headInHeadset = kNominalHeadInHeadset;  ///< [m]
  double lag = 0.0;                            ///< of the tracked head behind the headset [s], 0 to kLongestLag
  double residual = 0.0;  ///< median distance of the tracked head from where the headset says it is [m]

  // Standard deviations.
  double yawDeviation = 0.0;     ///< [rad]
  double levelDeviation = 0.0;   ///< horizontal distance of a place, over the places that were walked [m]
  double heightDeviation = 0.0;  ///< [m]

  /// The rigid motion that both members above make.
  [[nodiscard]] Isometry3 stageFromFloor() const;
  /// Where the tracker's head joint is, in the floor frame, for a pose of the headset in the stage frame.
  [[nodiscard]] Vec3 headInFloor(const Vec3& position, const Quat& orientation) const;
};

/// Finds a Registration from the tracked head of a person who walks about with a headset on. See docs/REGISTRATION.md.
///
/// Holds what came in the last 60 s, at most 4096 heads and 16384 headset poses; add...() allocates nothing. A sample
/// is ignored if it is not finite, further than 1 km away, or not later than the one before; but one that is more than
/// a second earlier means that the clock was set back, and all before it is forgotten. Both kinds share a clock. The
/// same samples give the same bits.
class HeadRegistration {
 public:
  static constexpr double kWindow = 60.0;                  ///< [s]
  static constexpr double kMaxYawDeviation = 0.017453293;  ///< 1 degree [rad]

  HeadRegistration();

  /// @param head  the tracked head joint, floor frame [m]; leave out what the tracker has not seen
  void addTracked(double time, const Vec3& head);
  /// @param position, orientation  of the headset, stage frame; the orientation need not be normalized
  void addHeadset(double time, const Vec3& position, const Quat& orientation);
  /// Forgets all samples: to be called when the camera or the stage was moved.
  void restart();

  /// Takes milliseconds, and allocates.
  /// @param start  a registration that is nearly right: takes less time; none = unknown
  /// @return the registration, or what is missing: a walk, its shape, the same floor, the same person
  [[nodiscard]] Result<Registration> solve(const std::optional<Registration>& start = {}) const;

  /// Whether the camera or the stage was moved since a registration: in the last 2 s the tracked head was off, by the
  /// median of each coordinate, by more than 5 cm and twice the registration's residual, and by twice the deviation of
  /// the level more. Allocates.
  [[nodiscard]] bool hasMoved(const Registration& known) const;

  /// The tracker's head joint in an image.
  struct TrackedHead {
    double time;    ///< [s]
    Vec3 position;  ///< floor frame [m]
  };
  /// What the headset says of itself.
  struct HeadsetPose {
    double time;       ///< [s], of the same clock
    Vec3 position;     ///< stage frame [m]
    Quat orientation;  ///< stageFromHeadset
  };

 private:
  std::vector<TrackedHead> heads_;
  std::vector<HeadsetPose> poses_;
};

/// What the person may do to make a registration surer, as a sentence; empty if it is sure enough.
[[nodiscard]] std::string adviceFor(const Registration& registration);

/// Whether a tracked body is the wrong way round: the headset looks to its back.
/// @param orientation  of the headset, stage frame
/// @param facing       where the tracked body faces, floor frame: (left shoulder - right shoulder) x up
[[nodiscard]] bool facesAway(const Registration& registration, const Quat& orientation, const Vec3& facing);

}  // namespace lorica
