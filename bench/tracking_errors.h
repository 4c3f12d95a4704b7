#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lorica::bench {

/// Off by more than this a joint counts as wrong [m].
inline constexpr double kWrong = 0.15;

/// One person in one frame.
struct JointErrors {
  double time = 0.0;     ///< [s]
  bool visible = false;  ///< the truth has the person in the image
  bool tracked = false;
  std::array<double, kBodyJointCount> distance{};  ///< of each joint from the truth [m]; where tracked
  std::array<bool, kBodyJointCount> sure{};        ///< confidence 0.5 or more
  bool sidesSwapped = false;                       ///< would fit better with left and right exchanged

  [[nodiscard]] double mean() const;
  /// Whether an elbow, hand, knee or foot is wrong; true where nobody is tracked.
  [[nodiscard]] bool limbWrong() const;
};

/// @param tracked  same frame as the truth; nothing where nobody is tracked
[[nodiscard]] JointErrors errorsOf(const SkeletonFrame& truth, bool visible,
                                   const std::optional<SkeletonFrame>& tracked);

/// What came of a run, or of several.
struct ErrorSummary {
  int frames = 0;  ///< that count
  double trackedPercent = 0.0;
  double meanMm = 0.0, medianMm = 0.0, p95Mm = 0.0;  ///< of all joints in tracked frames
  double limbWrongPercent = 0.0;                     ///< of frames
  double sureWrongPercent = 0.0;                     ///< of joints reported with confidence 0.5 or more
  double surePercent = 0.0;                          ///< of joints
  double swappedPercent = 0.0;                       ///< of tracked frames
};

/// @param runs  frames of each run, in order
/// @param from  frames count from this time on in each run [s]
[[nodiscard]] ErrorSummary summaryOf(std::span<const std::vector<JointErrors>> runs, double from);

/// From a time on: how long until no limb joint is wrong, for a sixth of a second at least.
/// @return [s]; nothing where that never is
[[nodiscard]] std::optional<double> secondsToFollow(std::span<const JointErrors> frames, double from);

}  // namespace lorica::bench
