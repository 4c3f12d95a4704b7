#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lorica::bench {

/// A joint with a larger error counts as wrong [m].
inline constexpr double kWrong = 0.15;

/// Errors of one person in one frame.
struct JointErrors {
  double time = 0.0;     ///< [s]
  bool visible = false;  ///< according to the ground truth, the person is in the image
  bool tracked = false;
  std::array<double, kBodyJointCount> distance{};  ///< of each joint from the ground truth [m]; if tracked
  std::array<bool, kBodyJointCount> sure{};        ///< confidence 0.5 or more
  bool sidesSwapped = false;                       ///< fits better with left and right swapped

  [[nodiscard]] double mean() const;
  /// Whether an elbow, hand, knee or foot is wrong; true if the person is not tracked.
  [[nodiscard]] bool limbWrong() const;
};

/// @param tracked  same frame as the truth; nothing if the person is not tracked
[[nodiscard]] JointErrors errorsOf(const SkeletonFrame& truth, bool visible,
                                   const std::optional<SkeletonFrame>& tracked);

/// Errors of one run or of several.
struct ErrorSummary {
  int frames = 0;  ///< number of frames evaluated
  double trackedPercent = 0.0;
  double meanMm = 0.0, medianMm = 0.0, p95Mm = 0.0;  ///< over all joints in tracked frames
  double limbWrongPercent = 0.0;                     ///< of frames
  double sureWrongPercent = 0.0;                     ///< of joints reported with confidence 0.5 or more
  double surePercent = 0.0;                          ///< of joints
  double swappedPercent = 0.0;                       ///< of tracked frames
};

/// @param runs  frames of each run, in order
/// @param from  time from which frames are evaluated in each run [s]
[[nodiscard]] ErrorSummary summaryOf(std::span<const std::vector<JointErrors>> runs, double from);

/// Time from `from` until no limb joint is wrong for at least a sixth of a second.
/// @return [s]; nothing if that never happens
[[nodiscard]] std::optional<double> secondsToFollow(std::span<const JointErrors> frames, double from);

}  // namespace lorica::bench
