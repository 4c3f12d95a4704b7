#pragma once

#include "skinning/skeleton.h"

#include <span>
#include <vector>

namespace lorica {

/// Keeps a limb calm while its joints are unknown: it holds its last pose, then eases to rest, and eases back
/// when it is seen again. Never jumps. One instance a person; call once a frame.
struct ConfidenceHoldSettings {
  double holdSeconds = 0.5;    ///< keep the last pose this long
  double easeSeconds = 1.0;    ///< then take this long to reach the rest rotation
  double returnSeconds = 0.2;  ///< blend back over this long when seen again
};

class ConfidenceHold {
 public:
  ConfidenceHold(const Skeleton& skeleton, const ConfidenceHoldSettings& settings);

  /// @param time        [s]
  /// @param known       one flag a joint of the skeleton: 1 where this frame determined its rotation
  /// @param pose        local transforms as retargeted; entries that are not known are replaced
  void apply(double time, std::span<const std::uint8_t> known, std::span<JointTransform> pose);

 private:
  struct JointState {
    Quat shown;  ///< what was returned last
    double lastKnownTime = 0.0;
    double blend = 1.0;
    Quat heldRotation;
    bool everKnown = false;
    bool lost = true;
  };
  ConfidenceHoldSettings settings_;
  std::vector<JointTransform> rest_;
  std::vector<JointState> states_;
  Vec3 shownRoot_ = Vec3::Zero();
  double lastTime_ = 0.0;
  bool started_ = false;
};

}  // namespace lorica
