#pragma once

#include "capture/synthetic/motion_rig.h"
#include "capture/synthetic/motion_track.h"

#include <vector>

namespace lorica::motion {

/// Where a flat foot stands: its ankle over (x, z), toes toward yaw.
struct Placement {
  double x = 0.0;
  double z = 0.0;
  double yaw = 0.0;
};

/// A place through which a foot in the air passes.
struct FootVia {
  double time;
  Vec3 ankle;
  double pitch = 0.0;        ///< toes-down; counts where follow is 0
  double follow = 0.0;       ///< see FootPose
  double followPitch = 0.0;  ///< see FootPose
};

/// From one placement to the next. Pitches are positive toes-down: then the ball of the foot is what touches.
struct Step {
  double lift = 0.0;  ///< the last instant of contact [s]
  double land = 0.0;  ///< the first one [s]
  Placement to;
  double apex = 0.05;        ///< rise of the ankle on the way, beyond the line between its ends [m]
  double offPitch = 0.5;     ///< as the toes leave
  double landPitch = -0.15;  ///< as the foot meets the floor: below 0 heel first
  double rollTime = 0.2;     ///< the heel rises for so long before lift [s]
  double settleTime = 0.12;  ///< the foot is flat so long after land [s]
  double touchdown = 0.25;   ///< speed at which the foot comes down [m/s]
  Vec3 bow = Vec3::Zero();   ///< how far the middle of the way lies beside the straight line [m]
  std::vector<FootVia> via = {};
};

/// The path of one foot over a whole motion. What touches the floor does not move while it touches.
class FootPath {
 public:
  FootPath() : FootPath(Placement{}, {}) {}
  /// @param steps      in time order, not overlapping
  /// @param heelRaise  toes-down pitch added while planted, to stand on tiptoe; 0 when steps roll
  FootPath(Placement start, std::vector<Step> steps, Track heelRaise = 0.0);

  [[nodiscard]] FootPose at(double time) const;
  /// The middle of the sole where it stands or will stand next.
  [[nodiscard]] Vec3 support(double time) const;
  /// True from `early` before a lift to the landing.
  [[nodiscard]] bool unloaded(double time, double early) const;

 private:
  [[nodiscard]] Vec3 plantedAnkle(const Placement& place, double time) const;

  struct Swing {
    Track x, y, z;
  };
  std::vector<Placement> places_;  ///< places_[i] until steps_[i] lifts
  std::vector<Step> steps_;
  std::vector<Swing> swings_;
  Track pitch_, follow_, followPitch_, heelRaise_;
};

/// The point over which a person keeps balance: midway between the feet, or over the one that stands.
/// @param early   weight is off a foot so long before it lifts [s]
/// @param spread  weight takes about twice this to go from foot to foot [s]
/// @param axis    0 for x, 2 for z
[[nodiscard]] Curve balanceOver(const FootPath& left, const FootPath& right, double early, double spread, int axis);

}  // namespace lorica::motion
