#pragma once

#include "tests/bench/generators/motion_rig.h"

#include <cstdint>
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
