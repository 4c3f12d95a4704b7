#pragma once

#include "capture/skeleton_frame.h"
#include "capture/tracking/fit/body_fit.h"
#include "geometry/counts.h"

#include <array>

namespace lorica::fit {

/// How much of each capsule a view shows, smoothed and converted to the confidence of joints.
///
/// A joint is trusted (0.5 or more) if enough of the capsules on its two sides was seen where the body model predicts
/// them. The thresholds were tuned on rendered people such that under 2 % of the trusted joints are off by more than
/// 150 mm; see docs/TRACKING.md.
class JointConfidence {
 public:
  /// After a restart all joints have low confidence for a few views.
  void restart();
  void update(const CapsuleSupport& support, bool attached);
  /// Of a joint, 0.1 to 1.
  [[nodiscard]] double operator[](BodyJoint joint) const { return confidence_[ordinalOf(joint)]; }
  /// Whether nothing of a limb was seen, see Limb.
  [[nodiscard]] bool hidden(int limb) const { return hidden_[limb]; }

 private:
  std::array<double, kBodyJointCount> confidence_{};
  std::array<bool, 4> hidden_{};
};

}  // namespace lorica::fit
