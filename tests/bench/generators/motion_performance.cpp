#include "tests/bench/generators/motion_performance.h"

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

namespace {

constexpr double kFrameRate = 30.0;

/// How far the pelvis must be lowered for both planted feet to be in reach [m].
double neededDrop(const SkeletonFrame& frame, const FootPath& left, const FootPath& right, double time) {
  constexpr double kReach = 0.9975 * kLeg;  // a knee never locks completely
  double drop = 0.0;
  for (const bool isLeft : {true, false}) {
    const FootPose foot = (isLeft ? left : right).at(time);
    const Vec3 hip = frame[isLeft ? BodyJoint::kLeftHip : BodyJoint::kRightHip].position;
    const Vec3 leg = hip - foot.ankle;
    if (foot.follow > 0.0) continue;
    const double flatSq = leg.x() * leg.x() + leg.z() * leg.z();
    drop = std::max(drop, leg.y() - std::sqrt(std::max(kReach * kReach - flatSq, 0.0)));
  }
  return drop;
}

}  // namespace

ArmCurve armThrough(const std::vector<ArmKey>& keys) {
  std::array<std::vector<TrackKey>, 6> channels;
  for (const ArmKey& key : keys) {
    const ArmPose arm = reach(key.hand, key.elbowPole);
    const double values[] = {arm.swing.x(), arm.swing.y(), arm.swing.z(), arm.elbow, key.twist, key.bend};
    for (std::size_t c = 0; c < channels.size(); ++c) channels[c].push_back({key.time, values[c]});
  }
  std::array<Track, 6> tracks;
  for (std::size_t c = 0; c < channels.size(); ++c) tracks[c] = Track(channels[c]);
  return [tracks](double time) {
    ArmPose arm;
    arm.swing = Vec3(tracks[0](time), tracks[1](time), tracks[2](time));
    arm.elbow = tracks[3](time);
    arm.twist = tracks[4](time);
    arm.bend = tracks[5](time);
    return arm;
  };
}

SkeletonFrame performAt(const Performance& p, double time, double drop) {
  const std::uint64_t seed = 1000 * p.seed;
  const double life = p.liveliness;
  const auto wander = [&](std::uint64_t channel, double amplitude) {
    return Wander(seed + channel, life * amplitude, 0.12, 0.7)(time);
  };
  // A breath every 3.6 s lifts chest and shoulders.
  const double breath = std::sin(2.0 * std::numbers::pi * time / 3.6 + 0.7 * p.seed);

  FigurePose pose;
  pose.worldFromPelvis = turned(p.heading(time) + wander(1, 0.02), p.pelvisPitch(time) + wander(2, 0.01),
                                p.pelvisRoll(time) + wander(3, 0.012));
  pose.pelvisFromChest =
      turned(p.chestTwist(time) + wander(4, 0.025), p.chestPitch(time) + wander(5, 0.015) - 0.008 * breath,
             p.chestRoll(time) + wander(6, 0.015));
  pose.worldFromHead = turned(p.headYaw(time) + wander(7, 0.05), p.headPitch(time) + wander(8, 0.03),
                              p.headRoll(time) + wander(9, 0.03));
  pose.shrug = 0.012 * breath;
  pose.arms = {p.leftArm(time), p.rightArm(time)};
  for (std::size_t s = 0; s < 2; ++s) {
    const std::uint64_t channel = 20 + 10 * s;
    pose.arms[s].swing += Vec3(wander(channel, 0.03), wander(channel + 1, 0.03), wander(channel + 2, 0.02));
    pose.arms[s].elbow = std::max(0.04, pose.arms[s].elbow + wander(channel + 3, 0.04));
    pose.arms[s].bend += wander(channel + 4, 0.06);
  }
  pose.feet = {p.leftFoot.at(time), p.rightFoot.at(time)};
  pose.kneeOut = {p.kneesOut(time), p.kneesOut(time)};
  const double swayX = wander(10, 0.008);
  const double swayZ = wander(11, 0.008);
  Vec3 target(p.x(time) + swayX, p.height(time) - drop, p.z(time) + swayZ);
  pose.pelvis = target;
  SkeletonFrame frame = solve(pose, time);
  // Moving the pelvis moves the centre of mass nearly as far, so a few corrections converge.
  for (int i = 0; i < 8; ++i) {
    Vec3 error = target - centreOfMass(frame);
    if (!p.groundIsCentreOfMass) error.x() = error.z() = 0.0;
    if (!p.heightIsCentreOfMass) error.y() = 0.0;
    if (error.squaredNorm() < 1e-20) break;
    pose.pelvis += 1.15 * error;
    frame = solve(pose, time);
  }
  return frame;
}

std::vector<SkeletonFrame> perform(const Performance& p) {
  const int frameCount = static_cast<int>(std::lround(p.duration * kFrameRate)) + 1;

  // First pass, at a finer time step than the frames: find where the pelvis must be lowered.
  constexpr int kFine = 4;
  constexpr int kReachOut = 14;  // fine samples, 0.12 s
  const int fineCount = (frameCount - 1) * kFine + 1;
  std::vector<double> needed(fineCount, 0.0);
  if (!p.heightIsCentreOfMass) {
    for (int i = 0; i < fineCount; ++i) {
      const double time = i / (kFrameRate * kFine);
      needed[i] = neededDrop(performAt(p, time), p.leftFoot, p.rightFoot, time);
    }
  }
  // The nearby maximum, then averaged over the same width: smooth and never less than needed.
  const auto clamped = [&](int i) { return static_cast<std::size_t>(std::clamp(i, 0, fineCount - 1)); };
  std::vector<double> widest(needed.size());
  for (int i = 0; i < fineCount; ++i) {
    for (int k = -kReachOut; k <= kReachOut; ++k) {
      widest[clamped(i)] = std::max(widest[clamped(i)], needed[clamped(i + k)]);
    }
  }
  std::vector<SkeletonFrame> frames;
  frames.reserve(frameCount);
  for (int f = 0; f < frameCount; ++f) {
    double drop = 0.0;
    double weights = 0.0;
    for (int k = -kReachOut; k <= kReachOut; ++k) {
      const double weight = 1.0 + std::cos(std::numbers::pi * k / (kReachOut + 1));
      drop += weight * widest[clamped(f * kFine + k)];
      weights += weight;
    }
    frames.push_back(performAt(p, f / kFrameRate, drop / weights));
  }
  return frames;
}

}  // namespace lorica::motion
