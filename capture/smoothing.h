#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <cstddef>
#include <vector>

namespace lorica {

/// Casiez, Roussel, Vogel: 1 Euro Filter, CHI 2012 (https://gery.casiez.net/1euro/).
/// Something that moves at a steady speed v [m/s] lags by 1 / (2 pi (minCutoff + beta v)) seconds.
struct OneEuroSettings {
  double minCutoff = 1.5;  ///< [Hz] at rest: lower is calmer and slower
  double beta = 5.0;       ///< [1/m] how much the cutoff rises with speed: higher lags less when fast
};

/// Smooths joints as they come, positions and orientations, and says how far it lags. Allocates nothing per frame.
/// One instance a person: it remembers. A joint that is unknown is passed on as unknown and starts anew when seen.
///
/// A joint's speed is that of its place, whichever way it goes; an orientation counts as fast as the end of a limb of
/// 0.3 m. Steps of time may differ; a frame that is not later than the one before shows what was shown then.
class OneEuroFilter {
 public:
  explicit OneEuroFilter(const OneEuroSettings& settings = {});

  void apply(SkeletonFrame& frame);

  /// How long the smoothed joints lag behind the measured ones [s], so far: the shift in time at which both agree best,
  /// over all seen joints.
  ///
  /// That is the lag d for which the sum of |smoothed(t) - measured(t - d)|^2 is least, over all frames and all joints
  /// seen for the half second before. Lags of 0, 10, ... 500 ms are tried, with measured places between frames taken
  /// from a straight line, and the least is refined by a parabola. What moves far counts most; 0 before anything moved.
  [[nodiscard]] double delay() const;

 private:
  static constexpr std::size_t kLags = 51;
  static constexpr double kLagStep = 0.01;    ///< [s]
  static constexpr double kPastStep = 0.004;  ///< least time between remembered frames [s]
  static constexpr std::size_t kPast = 128;   ///< so that the longest lag is remembered

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

  std::vector<Past> past_;     ///< a ring
  std::size_t pastCount_ = 0;  ///< ever remembered
  std::array<double, kLags> disagreement_{};
};

/// Swaps left and right and mirrors at the plane x = 0.
void mirror(SkeletonFrame& frame);

}  // namespace lorica
