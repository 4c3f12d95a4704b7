#pragma once

#include "capture/skeleton_frame.h"
#include "capture/tracking/fit/body_model.h"
#include "capture/tracking/fit/joint_confidence.h"
#include "capture/tracking/fit/limb_pose.h"

#include <array>

namespace lorica::fit {

/// The fitted pose as it is shown: a limb that is not seen well may be fitted elsewhere in each view, and is shown to
/// move no faster than people move theirs. What is seen well is shown where it is, without delay. Head and trunk, which
/// another pose may take elsewhere at once, are shown on the way there.
class CalmLimbs {
 public:
  /// The next pose is shown as it is.
  void restart() { started_ = false; }
  /// @param seconds  since the last pose
  void update(const BodyPose& pose, const Proportions& proportions, const JointConfidence& confidence, float seconds);

  /// To be called when the floor frame changed.
  void move(const Eigen::Isometry3f& newFromOld);

  [[nodiscard]] const BodyPose& pose() const { return shown_; }
  /// Makes joints unsure that are shown elsewhere than they were fitted.
  void doubt(SkeletonFrame& frame) const;

 private:
  bool started_ = false;
  BodyPose shown_;
  PosedModel fitted_, last_, next_;           ///< fitted_: the limbs as fitted, on the trunk as shown
  float trunkSpeed_ = 0.0F;                   ///< to the last pose [m/s]
  std::array<float, kFitLimbCount> speed_{};  ///< to the last pose, against the trunk [m/s]
  std::array<bool, kFitLimbCount> sure_{}, behind_{};
};

}  // namespace lorica::fit
