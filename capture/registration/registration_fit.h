#pragma once

#include "capture/registration/head_registration.h"

#include <span>
#include <vector>

namespace lorica::registration {

/// The headset's path between its samples.
class HeadsetPath {
 public:
  /// @param poses  times increase
  explicit HeadsetPath(std::span<const HeadRegistration::HeadsetPose> poses) : poses_(poses) {}

  /// Whether there are poses all the way between two times, without a long gap.
  [[nodiscard]] bool covers(double from, double to) const;
  /// Stage frame; the time must be covered.
  [[nodiscard]] Isometry3 at(double time) const;

 private:
  std::span<const HeadRegistration::HeadsetPose> poses_;
};

/// The tracked heads at whose times the headset's path is known for every lag.
[[nodiscard]] std::vector<HeadRegistration::TrackedHead> usable(std::span<const HeadRegistration::TrackedHead> heads,
                                                                const HeadsetPath& path);

/// Yaw, translation and lag for the nominal head: the best of 11 lags. Deviations are not set.
/// @param heads  usable ones, at least two
[[nodiscard]] Registration coarseFit(std::span<const HeadRegistration::TrackedHead> heads, const HeadsetPath& path);

/// All that is unknown, and how well it is known.
[[nodiscard]] Registration fineFit(std::span<const HeadRegistration::TrackedHead> heads, const HeadsetPath& path,
                                   const Registration& start);

/// The middle one of values in any order, which are reordered; there must be some.
[[nodiscard]] double medianOf(std::vector<double>& values);

}  // namespace lorica::registration
