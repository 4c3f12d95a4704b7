#pragma once

#include "capture/skeleton_frame.h"
#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Trust in the position of each limb of a character, computed from the confidences and speeds of the tracked joints.
/// The trust drops to 0 at once if a limb is guessed or faster than humanly possible, and recovers within 0.3 s, see
/// LivePart::trust. Allocates nothing per frame.
class JointTrust {
 public:
  explicit JointTrust(const Skeleton& skeleton);

  /// Processes the next frame of joints.
  void take(const SkeletonFrame& frame);

  /// Trust of each joint of the skeleton, 0 to 1. All 1 before the first frame.
  [[nodiscard]] std::span<const double> joints() const { return joints_; }

 private:
  /// The two tracked joints that determine a bone; equal if there is only one.
  using Source = std::array<BodyJoint, 2>;
  [[nodiscard]] static std::optional<Source> sourceOf(HumanBone bone);

  std::vector<std::optional<Source>> sources_;  ///< one per joint of the skeleton
  std::vector<double> joints_;
  std::optional<SkeletonFrame> before_;
  std::array<double, kBodyJointCount> tracked_{};
};

}  // namespace lorica
