#pragma once

#include "capture/skeleton_frame.h"
#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// How far the limbs of a character can be believed to be where they are shown: from what a tracker says of the
/// person's joints. A limb that is guessed, or that went faster than people can, is not believed at once, and comes
/// back within 0.3 s: see LivePart::trust. Allocates nothing per frame.
class JointTrust {
 public:
  explicit JointTrust(const Skeleton& skeleton);

  /// Takes the next frame of joints into account.
  void take(const SkeletonFrame& frame);

  /// For each joint of the skeleton, 0 to 1. All 1 before the first frame.
  [[nodiscard]] std::span<const double> joints() const { return joints_; }

 private:
  /// The tracked joints that a bone hangs on; twice the same where it is one.
  using Source = std::array<BodyJoint, 2>;
  [[nodiscard]] static std::optional<Source> sourceOf(HumanBone bone);

  std::vector<std::optional<Source>> sources_;  ///< one a joint of the skeleton
  std::vector<double> joints_;
  std::optional<SkeletonFrame> before_;
  std::array<double, kBodyJointCount> tracked_{};
};

}  // namespace lorica
