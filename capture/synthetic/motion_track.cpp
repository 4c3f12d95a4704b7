#include "capture/synthetic/motion_track.h"

#include "geometry/result.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica::motion {

double quintic(const CurvePoint& from, const CurvePoint& to, double duration, double u) {
  // Hermite form; the rates and accelerations are first scaled to the unit interval.
  const double u2 = u * u;
  const double u3 = u2 * u;
  const double u4 = u3 * u;
  const double u5 = u4 * u;
  const double blend = 10.0 * u3 - 15.0 * u4 + 6.0 * u5;
  const double rateIn = u - 6.0 * u3 + 8.0 * u4 - 3.0 * u5;
  const double rateOut = -4.0 * u3 + 7.0 * u4 - 3.0 * u5;
  const double bendIn = 0.5 * (u2 - 3.0 * u3 + 3.0 * u4 - u5);
  const double bendOut = 0.5 * (u3 - 2.0 * u4 + u5);
  return from.value + (to.value - from.value) * blend + duration * (from.rate * rateIn + to.rate * rateOut) +
         duration * duration * (from.acceleration * bendIn + to.acceleration * bendOut);
}

double minimumJerk(double u) {
  const double v = std::clamp(u, 0.0, 1.0);
  return v * v * v * (10.0 + v * (6.0 * v - 15.0));
}

Track::Track(std::vector<TrackKey> keys) {
  LORICA_CHECK(!keys.empty(), "a track needs at least one key");
  const std::size_t count = keys.size();
  for (std::size_t i = 0; i < count; ++i) {
    LORICA_CHECK(i == 0 || keys[i].time > keys[i - 1].time, "track key times must increase");
    CurvePoint point{keys[i].value, 0.0, 0.0};
    if (i > 0 && i + 1 < count) {
      const double before = keys[i].time - keys[i - 1].time;
      const double after = keys[i + 1].time - keys[i].time;
      const double slopeIn = (keys[i].value - keys[i - 1].value) / before;
      const double slopeOut = (keys[i + 1].value - keys[i].value) / after;
      if (slopeIn * slopeOut > 0.0) {
        // Harmonic mean (Fritsch and Butland 1984): flows through the key without overshoot.
        point.rate = 2.0 * slopeIn * slopeOut / (slopeIn + slopeOut);
      } else if (slopeIn * slopeOut < 0.0) {
        // A sine over both halves would have pi^2 / 2 times slope over duration.
        const double sharpness = std::min(std::abs(slopeIn) / before, std::abs(slopeOut) / after);
        point.acceleration = (slopeIn > 0.0 ? -4.9 : 4.9) * sharpness;
      }
    }
    if (keys[i].rate) {
      point.rate = *keys[i].rate;
      point.acceleration = 0.0;
    }
    keys_.push_back(point);
    times_.push_back(keys[i].time);
  }
}

double Track::operator()(double time) const {
  if (time <= times_.front()) return keys_.front().value;
  if (time >= times_.back()) return keys_.back().value;
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const std::size_t i = after - times_.begin();
  const double duration = times_[i] - times_[i - 1];
  return quintic(keys_[i - 1], keys_[i], duration, (time - times_[i - 1]) / duration);
}

Wander::Wander(std::uint64_t seed, double amplitude, double slowest, double fastest) {
  RandomNumbers random(seed);
  constexpr int kWaves = 5;
  for (int i = 0; i < kWaves; ++i) {
    const double frequency = slowest + (fastest - slowest) * (i + random.unit()) / kWaves;
    // Slow waves have the largest amplitudes, as in quiet standing.
    const double share = 0.45 * slowest / frequency + 0.1;
    waves_.push_back({amplitude * share, frequency, random.between(0.0, 2.0 * std::numbers::pi)});
  }
}

double Wander::operator()(double time) const {
  double sum = 0.0;
  for (const Wave& w : waves_) sum += w.amplitude * std::sin(2.0 * std::numbers::pi * w.frequency * time + w.phase);
  return sum;
}

}  // namespace lorica::motion
