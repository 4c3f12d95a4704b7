#pragma once

#include "geometry/random_numbers.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// Tools for writing the shipped motions: keyed curves and seeded randomness.
namespace lorica::motion {

/// A channel of a motion over time [s].
using Curve = std::function<double(double)>;

[[nodiscard]] constexpr double degrees(double value) {
  return value * 3.14159265358979323846 / 180.0;
}

/// Position, velocity and acceleration of a curve at one time.
struct CurvePoint {
  double value = 0.0;
  double rate = 0.0;
  double acceleration = 0.0;
};

/// The quintic from `from` to `to` over `duration`; u in [0, 1] is the elapsed fraction.
[[nodiscard]] double quintic(const CurvePoint& from, const CurvePoint& to, double duration, double u);

/// 0 to 1 with no velocity or acceleration at either end (minimum jerk); clamped outside [0, 1].
[[nodiscard]] double minimumJerk(double u);

struct TrackKey {
  double time;
  double value;
  std::optional<double> rate = {};  ///< if omitted, chosen so that the curve never overshoots its keys
};

/// A curve through keys, continuous up to acceleration, constant before the first key and after the last.
///
/// Between rising keys it flows through; at a turning point it reverses like a sine; between equal keys it stays
/// constant.
class Track {
 public:
  Track(double constant = 0.0) : keys_{{constant, 0.0, 0.0}}, times_{0.0} {}
  /// @param keys  at least one, times strictly rising
  Track(std::vector<TrackKey> keys);
  Track(std::initializer_list<TrackKey> keys) : Track(std::vector<TrackKey>(keys)) {}

  double operator()(double time) const;

 private:
  std::vector<CurvePoint> keys_;
  std::vector<double> times_;
};

/// Slow, smooth, aperiodic wandering about zero, so that a standing person is not motionless.
class Wander {
 public:
  /// @param amplitude  approximate max excursion
  /// @param slowest, fastest  frequency range [Hz]
  Wander(std::uint64_t seed, double amplitude, double slowest, double fastest);
  double operator()(double time) const;

 private:
  struct Wave {
    double amplitude, frequency, phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace lorica::motion
