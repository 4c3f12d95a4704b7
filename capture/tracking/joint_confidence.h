#pragma once

#include "capture/skeleton_frame.h"
#include "capture/tracking/body_fit.h"

#include <array>

namespace lorica::fit {

/// How much of each capsule a view shows, smoothed and made into the confidence of joints.
///
/// A joint is trusted, 0.5 and more, if enough of what lies on its two sides was seen where the body says. The measures
/// were set so that on rendered people under 2 % of the trusted joints are off by more than 150 mm; see
/// docs/TRACKING.md.
class JointConfidence {
 public:
  /// After a start all are doubted for a few views.
  void restart();
  void update(const CapsuleSupport& support);
  /// Of a joint, 0.1 to 1.
  [[nodiscard]] double operator[](BodyJoint joint) const { return confidence_[static_cast<std::size_t>(joint)]; }
  /// Whether nothing of a limb was seen, see Limb.
  [[nodiscard]] bool hidden(int limb) const { return hidden_[static_cast<std::size_t>(limb)]; }

 private:
  std::array<double, kBodyJointCount> confidence_{};
  std::array<bool, 4> hidden_{};
};

}  // namespace lorica::fit
