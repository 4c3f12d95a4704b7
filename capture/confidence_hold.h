#pragma once

#include "skinning/skeleton.h"

#include <vector>

namespace lorica {

struct ConfidenceHoldSettings {
  double holdSeconds = 0.5;    ///< keep the last pose this long
  double easeSeconds = 1.0;    ///< then take this long to reach the rest rotation
  double returnSeconds = 0.2;  ///< blend back over this long when seen again after a whole hold
  double returnTurn = 12.0;    ///< and never faster than this [rad/s]
  double returnSpeed = 4.0;    ///< nor, for the root's place, than this [m/s]
};

/// Keeps a limb calm while its joints are unknown: it holds its last pose, then eases to rest, and eases back
/// when it is seen again. The root's place is held and never eased. Never jumps: what is shown moves by itself only
/// as fast as the settings say. One instance a person. Allocates nothing after construction.
///
/// Each frame: beginFrame, then every joint once, parents first. A joint at a time, because the local rotation that
/// a seen joint needs depends on what its unseen parent shows.
class ConfidenceHold {
 public:
  ConfidenceHold(const Skeleton& skeleton, const ConfidenceHoldSettings& settings);

  /// @param time  [s]; a step backwards counts as none, a long one as 0.1 s
  void beginFrame(double time);

  /// What to show for a joint. In the first frame a known joint is shown as it is; a joint never known shows rest.
  /// @param known  whether this frame determined `local`; without it `local` is not read
  /// @param local  parentFromJoint rotation as retargeted
  [[nodiscard]] Quat rotation(JointIndex joint, bool known, const Quat& local);

  /// Where to show the root; `fallback` before the first sighting [m].
  [[nodiscard]] Vec3 rootPlace(bool known, const Vec3& place, const Vec3& fallback);

  /// Time that passed since the frame before, as counted here [s]; 0 in the first frame.
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] bool inFirstFrame() const { return frameCount_ == 1; }

 private:
  /// How far the shown value is trusted to be the live one: 1 follows it, below 1 blends towards it.
  struct Trust {
    double value = 0.0;
    double lostSeconds = 0.0;
    bool everKnown = false;
  };
  struct JointState {
    Trust trust;
    Quat shown = Quat::Identity();
    Quat held = Quat::Identity();  ///< where easing to rest starts
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
