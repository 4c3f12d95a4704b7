#pragma once

#include "capture/synthetic/motion_rig.h"
#include "capture/synthetic/motion_track.h"

#include <vector>

namespace lorica::motion {

/// Placement of a flat foot: ankle above (x, z), toes towards yaw.
struct Placement {
  double x = 0.0;
  double z = 0.0;
  double yaw = 0.0;
};

/// A position that a foot passes through in the air.
struct FootVia {
  double time;
  Vec3 ankle;
  double pitch = 0.0;        ///< toes-down; used where follow is 0
  double follow = 0.0;       ///< see FootPose
  double followPitch = 0.0;  ///< see FootPose
};

/// From one placement to the next. Positive pitches are toes-down: then the ball of the foot touches the floor.
struct Step {
  double lift = 0.0;  ///< last instant of contact [s]
  double land = 0.0;  ///< first instant of contact [s]
  Placement to;
  double apex = 0.05;        ///< rise of the ankle on the way, above the line between start and end [m]
  double offPitch = 0.5;     ///< when the toes leave the floor
  double landPitch = -0.15;  ///< when the foot meets the floor: below 0 heel first
  double rollTime = 0.2;     ///< the heel starts to rise this long before lift [s]
  double settleTime = 0.12;  ///< the foot is flat this long after land [s]
  double touchdown = 0.25;   ///< downward speed of the foot at contact [m/s]
  Vec3 bow = Vec3::Zero();   ///< lateral offset of the path's midpoint from the straight line [m]
  std::vector<FootVia> via = {};
};

/// The path of one foot over a whole motion. The point that touches the floor does not move while it touches.
class FootPath {
 public:
  FootPath() : FootPath(Placement{}, {}) {}
  /// @param steps      in time order, not overlapping
  /// @param heelRaise  toes-down pitch added while planted, to stand on tiptoe; 0 when steps roll
  FootPath(Placement start, std::vector<Step> steps, Track heelRaise = 0.0);

  [[nodiscard]] FootPose at(double time) const;
  /// The middle of the sole at its current or next placement.
  [[nodiscard]] Vec3 support(double time) const;
  /// True from `early` before a lift to the landing.
  [[nodiscard]] bool unloaded(double time, double early) const;

 private:
  [[nodiscard]] Vec3 plantedAnkle(const Placement& position, double time) const;

  struct Swing {
    Track x, y, z;
  };
  std::vector<Placement> positions_;  ///< positions_[i] until steps_[i] lifts
  std::vector<Step> steps_;
  std::vector<Swing> swings_;
  Track pitch_, follow_, followPitch_, heelRaise_;
};

/// The point over which a person keeps balance: midway between the feet, or above the standing foot.
/// @param early   weight leaves a foot this long before it lifts [s]
/// @param spread  shifting the weight from foot to foot takes about twice this time [s]
/// @param axis    0 for x, 2 for z
[[nodiscard]] Curve balanceOver(const FootPath& left, const FootPath& right, double early, double spread, int axis);

}  // namespace lorica::motion
