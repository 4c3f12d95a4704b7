#pragma once

#include "skinning/skeleton.h"

#include <vector>

namespace lorica {

/// What becomes of bones that are not seen.
struct ConfidenceHoldSettings {
  double holdSeconds = 0.5;    ///< how long to keep the last pose
  double easeSeconds = 1.0;    ///< duration of the following ease to the rest rotation
  double returnSeconds = 0.2;  ///< blend duration when the joint is seen again after a full hold
  double returnTurn = 12.0;    ///< max angular speed of that blend [rad/s]
  double returnSpeed = 4.0;    ///< max speed of that blend for the root's position [m/s]
};

/// Steadies a limb while its joints are unknown: holds the last pose, eases to rest, and eases back when the joints are
/// seen again. The root's position is held and never eased. Output never jumps: its own motion is limited to the speeds
/// in the settings. Use one instance per person. Allocates nothing after construction.
///
/// Each frame: call beginFrame, then rotation() once for every joint, parents first. Joints are processed one at a time
/// because the local rotation of a seen joint depends on the output of its unseen parent.
class ConfidenceHold {
 public:
  /// One for each character and person.
  ConfidenceHold(const Skeleton& skeleton, const ConfidenceHoldSettings& settings);

  /// @param time  [s]; a step backwards counts as 0, a long step as 0.1 s
  void beginFrame(double time);

  /// Returns the rotation to show for a joint. In the first frame a known joint is passed through; a joint that was
  /// never known gets the rest rotation.
  /// @param known  whether this frame determined `local`; if false, `local` is not read
  /// @param local  parentFromJoint rotation as retargeted
  [[nodiscard]] Quat rotation(JointIndex joint, bool known, const Quat& local);

  /// Returns the root position to show; `fallback` until the root is first seen [m].
  [[nodiscard]] Vec3 rootPosition(bool known, const Vec3& position, const Vec3& fallback);

  /// Time since the previous frame after the limits of beginFrame() [s]; 0 in the first frame.
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] bool inFirstFrame() const { return frameCount_ == 1; }  ///< of this object

 private:
  /// Blend state: 1 follows the live value, below 1 blends towards it.
  struct Trust {
    double value = 0.0;
    double lostSeconds = 0.0;
    bool everKnown = false;
  };
  struct JointState {
    Trust trust;
    Quat shown = Quat::Identity();
    Quat held = Quat::Identity();  ///< start of the ease to rest
    Quat rest = Quat::Identity();
  };

  [[nodiscard]] double shareTowardsLive(Trust& trust, double distance, double largestSpeed) const;
  void lose(Trust& trust) const;

  ConfidenceHoldSettings settings_;
  std::vector<JointState> joints_;
  Trust rootTrust_;
  Vec3 shownRoot_ = Vec3::Zero();
  double lastTime_ = 0.0;
  double step_ = 0.0;
  long frameCount_ = 0;
};

}  // namespace lorica
