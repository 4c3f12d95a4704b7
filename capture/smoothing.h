#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <cstddef>
#include <vector>

namespace lorica {

/// Casiez, Roussel, Vogel: 1 Euro Filter, CHI 2012 (https://gery.casiez.net/1euro/).
/// A point moving at constant speed v [m/s] lags by 1 / (2 pi (minCutoff + beta v)) seconds.
struct OneEuroSettings {
  double minCutoff = 1.5;  ///< [Hz] at rest: lower is smoother and slower
  double beta = 5.0;       ///< [1/m] how strongly the cutoff rises with speed: higher lags less at high speed
};

/// Smooths joint positions and orientations as they arrive and reports its lag. Allocates nothing per frame. Stateful:
/// use one instance per person. An unknown joint is passed on as unknown; smoothing restarts when it is seen again.
///
/// A joint's speed is the speed of its position in any direction; an orientation counts as the speed of the end of a
/// 0.3 m limb. Time steps may vary. A frame that is not later than the previous one repeats the previous output.
class OneEuroFilter {
 public:
  /// One for each person.
  explicit OneEuroFilter(const OneEuroSettings& settings = {});

  /// Smooths the positions of a frame; times increase.
  void apply(SkeletonFrame& frame);

  /// Lag of the smoothed joints behind the measured ones so far [s]: the time shift at which both agree best, over all
  /// seen joints.
  ///
  /// This is the lag d that minimises the sum of |smoothed(t) - measured(t - d)|^2 over all frames and all joints seen
  /// for the preceding half second. Lags of 0, 10, ... 500 ms are tried, with measured positions interpolated linearly
  /// between frames, and the minimum is refined by a parabola. Larger motion has more weight; 0 before anything moved.
  [[nodiscard]] double delay() const;

 private:
  static constexpr std::size_t kLags = 51;
  static constexpr double kLagStep = 0.01;    ///< [s]
  static constexpr double kPastStep = 0.004;  ///< min time between stored frames [s]
  static constexpr std::size_t kPast = 128;   ///< enough for the longest lag

  struct Joint {
    bool seen = false;
    Vec3 measured, smoothed, velocity;
    bool turned = false;
    Quat measuredTurn, smoothedTurn;
    Vec3 turnVelocity;
    double seenSince = 0.0;
  };
  struct Past {
    double time = 0.0;
    std::array<Vec3, kBodyJointCount> measured;
  };

  void smooth(Joint& joint, TrackedJoint& tracked, double step, double time) const;
  void remember(const SkeletonFrame& measured);
  void compare(const SkeletonFrame& measured, const SkeletonFrame& smoothed);
  [[nodiscard]] const Past& past(std::size_t framesAgo) const;

  OneEuroSettings settings_;
  std::array<Joint, kBodyJointCount> joints_;
  double lastTime_ = 0.0;
  bool first_ = true;

  std::vector<Past> past_;     ///< ring buffer
  std::size_t pastCount_ = 0;  ///< total number of frames stored so far
  std::array<double, kLags> disagreement_{};
};

/// Exchanges left and right and mirrors at the plane x = 0.
void mirror(SkeletonFrame& frame);

}  // namespace lorica
