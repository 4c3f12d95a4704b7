#include "capture/synthetic/motion_performance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica::motion {

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
