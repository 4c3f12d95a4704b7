#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// The small tools that the shipped motions are written with: keyed curves and seeded randomness.
namespace lorica::motion {

/// A channel of a motion over time [s].
using Curve = std::function<double(double)>;

[[nodiscard]] constexpr double degrees(double value) {
  return value * 3.14159265358979323846 / 180.0;
}

/// Steele, Lea, Flood 2014 (SplitMix64): the same numbers on every machine.
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  /// Uniform in [0, 1).
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Nearly normal, mean 0, deviation 1: twelve uniforms, so no library function decides its bits.
  double normal();

 private:
  std::uint64_t state_;
};

/// Position, velocity and acceleration of a curve at one time.
struct CurvePoint {
  double value = 0.0;
  double rate = 0.0;
  double acceleration = 0.0;
};

/// The quintic that leaves `from` and arrives at `to` after `duration`; u in [0, 1] is the share of it gone by.
[[nodiscard]] double quintic(const CurvePoint& from, const CurvePoint& to, double duration, double u);

/// 0 to 1 with no velocity or acceleration at either end (minimum jerk); clamped outside [0, 1].
[[nodiscard]] double minimumJerk(double u);

struct TrackKey {
  double time;
  double value;
  std::optional<double> rate = {};  ///< left out: chosen so that the curve never overshoots its keys
};

/// A curve through keys, continuous up to acceleration, constant before the first key and after the last.
///
/// Between keys that rise it flows through; at a turning point it swings over like a sine; where two keys are equal
/// it holds.
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

/// Slow, smooth, aperiodic wandering about zero: what keeps a standing person from being a statue.
class Wander {
 public:
  /// @param amplitude  about the largest excursion
  /// @param slowest, fastest  range of its frequencies [Hz]
  Wander(std::uint64_t seed, double amplitude, double slowest, double fastest);
  double operator()(double time) const;

 private:
  struct Wave {
    double amplitude, frequency, phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace lorica::motion
