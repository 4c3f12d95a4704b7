#include "capture/synthetic/motion_feet.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica::motion {

FootPath::FootPath(Placement start, std::vector<Step> steps, Track heelRaise)
    : positions_{start}, steps_(std::move(steps)), heelRaise_(std::move(heelRaise)) {
  std::vector<TrackKey> pitch{{-10.0, 0.0}};
  std::vector<TrackKey> follow{{-10.0, 0.0}};
  std::vector<TrackKey> followPitch{{-10.0, 0.0}};
  for (const Step& step : steps_) {
    pitch.push_back({std::max(step.lift - step.rollTime, pitch.back().time + 0.01), 0.0});
    pitch.push_back({step.lift, step.offPitch});
    follow.push_back({step.lift, 0.0});
    followPitch.push_back({step.lift, 0.0});
    // The toes leave while the foot still rotates, so the pitch peaks in the air.
    if (step.via.empty()) {
      pitch.push_back({step.lift + 0.17 * (step.land - step.lift), 1.12 * step.offPitch});
    }
    for (const FootVia& via : step.via) {
      pitch.push_back({via.time, via.pitch});
      follow.push_back({via.time, via.follow});
      followPitch.push_back({via.time, via.followPitch});
    }
    pitch.push_back({step.land, step.landPitch});
    pitch.push_back({step.land + step.settleTime, 0.0});
    follow.push_back({step.land, 0.0});
    followPitch.push_back({step.land, 0.0});
    positions_.push_back(step.to);
  }
  pitch_ = Track(std::move(pitch));
  follow_ = Track(std::move(follow));
  followPitch_ = Track(std::move(followPitch));

  // At both ends a swing matches the velocity of the rolling foot.
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Step& step = steps_[i];
    constexpr double kInstant = 1e-4;
    constexpr double kPush = 0.15;  // the toes clear the floor at once [m/s]
    const Vec3 from = plantedAnkle(positions_[i], step.lift);
    const Vec3 fromRate = (from - plantedAnkle(positions_[i], step.lift - kInstant)) / kInstant + kPush * Vec3::UnitY();
    const Vec3 to = plantedAnkle(step.to, step.land);
    // A foot lands with a small impact; a soft landing would look like skating.
    const Vec3 toRate = (plantedAnkle(step.to, step.land + kInstant) - to) / kInstant - step.touchdown * Vec3::UnitY();
    std::array<std::vector<TrackKey>, 3> keys;
    for (int axis = 0; axis < 3; ++axis) {
      auto& k = keys[axis];
      k.push_back({step.lift, from[axis], fromRate[axis]});
      for (const FootVia& via : step.via) k.push_back({via.time, via.ankle[axis]});
      k.push_back({step.land, to[axis], toRate[axis]});
    }
    swings_.push_back({Track(keys[0]), Track(keys[1]), Track(keys[2])});
  }
}

Vec3 FootPath::plantedAnkle(const Placement& position, double time) const {
  const double pitch = pitch_(time) + heelRaise_(time);
  const double pivot = pitch > 0.0 ? kBallAhead : -kHeelBehind;
  return Vec3(position.x, 0.0, position.z) +
         turned(position.yaw, 0.0, 0.0) * (Vec3(0.0, 0.0, pivot) + turned(0.0, pitch, 0.0) * Vec3(0.0, kAnkle, -pivot));
}

FootPose FootPath::at(double time) const {
  FootPose pose;
  std::size_t i = 0;
  while (i < steps_.size() && time >= steps_[i].land) ++i;
  if (i == steps_.size() || time <= steps_[i].lift) {
    pose.ankle = plantedAnkle(positions_[i], time);
    pose.rotation = turned(positions_[i].yaw, pitch_(time) + heelRaise_(time), 0.0);
    return pose;
  }
  const Step& step = steps_[i];
  const Swing& swing = swings_[i];
  const double u = (time - step.lift) / (step.land - step.lift);
  const double bump = 4.0 * u * (1.0 - u);
  pose.planted = false;
  pose.ankle = Vec3(swing.x(time), swing.y(time), swing.z(time));
  if (step.via.empty()) pose.ankle.y() += step.apex * bump * bump;
  const double gone = minimumJerk(u);
  pose.ankle += 4.0 * gone * (1.0 - gone) * step.bow;
  pose.rotation = turned(positions_[i].yaw + (step.to.yaw - positions_[i].yaw) * minimumJerk(u), pitch_(time), 0.0);
  pose.follow = follow_(time);
  pose.followPitch = followPitch_(time);
  return pose;
}

Vec3 FootPath::support(double time) const {
  std::size_t i = 0;
  while (i < steps_.size() && time >= 0.5 * (steps_[i].lift + steps_[i].land)) ++i;
  const Placement& position = positions_[i];
  return Vec3(position.x, 0.0, position.z) + turned(position.yaw, 0.0, 0.0) * Vec3(0.0, 0.0, 0.03);
}

bool FootPath::unloaded(double time, double early) const {
  return std::any_of(steps_.begin(), steps_.end(),
                     [&](const Step& step) { return time > step.lift - early && time < step.land; });
}

Curve balanceOver(const FootPath& left, const FootPath& right, double early, double spread, int axis) {
  return [=](double time) {
    // A raised-cosine window over the weight-bearing feet: continuous like a real weight shift, although contact is
    // not.
    constexpr int kSamples = 48;
    double sum = 0.0;
    double weights = 0.0;
    for (int k = -kSamples; k <= kSamples; ++k) {
      const double share = static_cast<double>(k) / (kSamples + 1);
      const double at = time + 2.0 * spread * share;
      const double weight = 1.0 + std::cos(std::numbers::pi * share);
      const bool leftBears = !left.unloaded(at, early);
      const bool rightBears = !right.unloaded(at, early);
      const double l = left.support(at)[axis];
      const double r = right.support(at)[axis];
      sum += weight * (leftBears == rightBears ? 0.5 * (l + r) : leftBears ? l : r);
      weights += weight;
    }
    return sum / weights;
  };
}

}  // namespace lorica::motion
