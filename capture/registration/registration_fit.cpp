#include "capture/registration/registration_fit.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>

namespace lorica::registration {
namespace {

using TrackedHead = HeadRegistration::TrackedHead;
using HeadsetPose = HeadRegistration::HeadsetPose;

constexpr double kLongestGap = 0.1;  ///< between samples of the headset that are interpolated [s]
constexpr double kLagStep = 0.02;    ///< [s]
constexpr int kLags = 11;
constexpr int kReweighted = 8;       ///< times, for each lag
constexpr double kBadlyOff = 0.03;   ///< scale of the cost that compares lags [m]
constexpr double kSpeedStep = 0.01;  ///< over which the headset's speed is measured [s]

constexpr double kOffsetPrior = 0.03;  ///< of the head in the headset about the nominal one [m]
constexpr double kFloorPrior = 0.015;  ///< of the two floors' heights [m]
constexpr double kLagPrior = 0.1;      ///< about the middle of what is possible [s]
constexpr double kYawPrior = 3.0;      ///< so weak that it only keeps the equations solvable [rad]
constexpr double kLeastNoise = 0.01;   ///< of a coordinate of the head: some errors of a tracker do not average out [m]
constexpr double kMedianOfThree = 1.5382;            ///< median length of three normal deviates
constexpr int kRounds = 3;                           ///< of fitting, and measuring the noise
constexpr int kSteps = 20;                           ///< of each fit, at most
constexpr double kBlock = 0.5, kLongestBlock = 3.0;  ///< over which noise is correlated [s]
constexpr int kBlocks = 20;

// The unknowns: yaw and translation of floorFromStage, head in the headset, lag.
constexpr int kYaw = 0, kMove = 1, kHead = 4, kLag = 7, kUnknowns = 8;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Equations = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Jacobian = Eigen::Matrix<double, 3, kUnknowns>;

Vec3 turned(double yaw, const Vec3& v) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {c * v.x() + s * v.z(), v.y(), c * v.z() - s * v.x()};
}
/// How a turned vector changes with its yaw.
Vec3 turning(const Vec3& v) {
  return {v.z(), 0.0, -v.x()};
}

Registration registrationOf(const Unknowns& x) {
  Registration found;
  found.yaw = std::remainder(-x[kYaw], 2.0 * std::numbers::pi);
  found.translation = -turned(-x[kYaw], x.segment<3>(kMove));
  found.headInHeadset = x.segment<3>(kHead);
  found.lag = x[kLag];
  return found;
}

Unknowns unknownsOf(const Registration& known) {
  Unknowns x;
  x[kYaw] = -known.yaw;
  x.segment<3>(kMove) = -turned(-known.yaw, known.translation);
  x.segment<3>(kHead) = known.headInHeadset;
  x[kLag] = known.lag;
  return x;
}

/// What is to be least: Cauchy's loss of the distances, with weak beliefs about what they cannot tell.
class Fit {
 public:
  struct Here {
    double cost = 0.0;
    Equations equations = Equations::Zero();
    Unknowns slope = Unknowns::Zero();
  };

  Fit(std::span<const TrackedHead> heads, const HeadsetPath& path) : heads_(heads), path_(path) {
    believed_.setZero();
    believed_.segment<3>(kHead) = kNominalHeadInHeadset;
    believed_[kLag] = 0.5 * kLongestLag;
    belief_ << kYawPrior, kInfinity, kFloorPrior, kInfinity, kOffsetPrior, kOffsetPrior, kOffsetPrior, kLagPrior;
    belief_ = belief_.cwiseAbs2().cwiseInverse().eval();
  }

  /// Of one tracked head: where the headset says it is, less where it is seen.
  [[nodiscard]] Vec3 off(const Unknowns& x, const TrackedHead& head) const {
    return turned(x[kYaw], path_.at(head.time - x[kLag]) * x.segment<3>(kHead)) + x.segment<3>(kMove) - head.position;
  }
  [[nodiscard]] double weightOf(const Vec3& off) const { return 1.0 / (1.0 + off.squaredNorm() / scaleSq_); }

  [[nodiscard]] Here at(const Unknowns& x) const {
    Here here;
    for (const TrackedHead& head : heads_) {
      const double when = head.time - x[kLag];
      const Isometry3 stageFromHeadset = path_.at(when);
      const Vec3 offset = x.segment<3>(kHead);
      const Vec3 speed =
          (path_.at(when + kSpeedStep) * offset - path_.at(when - kSpeedStep) * offset) / (2.0 * kSpeedStep);
      const Vec3 joint = turned(x[kYaw], stageFromHeadset * offset);
      const Vec3 apart = joint + x.segment<3>(kMove) - head.position;
      Jacobian change;
      change.col(kYaw) = turning(joint);
      change.middleCols<3>(kMove).setIdentity();
      for (int k = 0; k < 3; ++k) change.col(kHead + k) = turned(x[kYaw], stageFromHeadset.linear().col(k));
      change.col(kLag) = -turned(x[kYaw], speed);
      const double weight = weightOf(apart) / noiseSq_;
      here.cost += 0.5 * scaleSq_ / noiseSq_ * std::log1p(apart.squaredNorm() / scaleSq_);
      here.equations.noalias() += weight * change.transpose() * change;
      here.slope.noalias() += weight * change.transpose() * apart;
    }
    Unknowns unlike = x - believed_;
    unlike[kYaw] = 0.0;  // nothing is believed of it
    here.cost += 0.5 * unlike.cwiseAbs2().dot(belief_);
    here.equations.diagonal() += belief_;
    here.slope += unlike.cwiseProduct(belief_);
    return here;
  }

  /// Levenberg and Marquardt's way down.
  void descend(Unknowns& x) const {
    Here here = at(x);
    double damping = 1e-3;
    for (int step = 0; step < kSteps && damping < 1e6; ++step) {
      Equations damped = here.equations;
      damped.diagonal() *= 1.0 + damping;
      Unknowns next = x - damped.llt().solve(here.slope);
      next[kLag] = std::clamp(next[kLag], 0.0, kLongestLag);
      const Here there = at(next);
      if (!(there.cost < here.cost)) {
        damping *= 10.0;
        continue;
      }
      const bool done = here.cost - there.cost < 1e-8 * here.cost;
      x = next;
      here = there;
      damping *= 0.1;
      if (done) break;
    }
  }

  /// Learns how large the noise is, and for how long it stays the same: 15 mm that change with every frame average out
  /// sooner than 15 mm that stay for ten.
  /// @return the median distance
  double measureNoise(const Unknowns& x) {
    std::vector<double> distances;
    for (const TrackedHead& head : heads_) distances.push_back(off(x, head).norm());
    const double median = medianOf(distances);
    const double noise = std::max(median / kMedianOfThree, kLeastNoise);
    scaleSq_ = std::pow(2.0 * kMedianOfThree * noise, 2);
    // Sums over blocks are as large as those of single values, if these know nothing of each other.
    double together = 0.0, alone = 0.0;
    int values = 3;
    Vec3 block = Vec3::Zero();
    double begun = heads_.front().time;
    const double length = std::clamp((heads_.back().time - begun) / kBlocks, kBlock, kLongestBlock);
    for (const TrackedHead& head : heads_) {
      if (head.time - begun > length) {
        together += block.squaredNorm();
        block.setZero();
        values += 3;
        begun = head.time;
      }
      const Vec3 apart = off(x, head);
      const Vec3 pull = weightOf(apart) * apart;
      block += pull;
      alone += pull.squaredNorm();
    }
    together += block.squaredNorm();
    // What was fitted took its share of them.
    const double lost = 1.0 * values / std::max(values - kUnknowns, 3);
    noiseSq_ = noise * noise * std::max(1.0, lost * together / std::max(alone, 1e-12));
    return median;
  }

  /// How well it is known, from how steeply the cost rises.
  void judge(const Unknowns& x, Registration& found) const {
    const Equations covariance = at(x).equations.llt().solve(Equations::Identity());
    double levelSq = 0.0;
    for (const TrackedHead& head : heads_) {
      Jacobian change = Jacobian::Zero();
      change.col(kYaw) = turning(turned(x[kYaw], path_.at(head.time - x[kLag]).translation()));
      change.middleCols<3>(kMove).setIdentity();
      const Mat3 place = change * covariance * change.transpose();
      levelSq += (place(0, 0) + place(2, 2)) / heads_.size();
    }
    found.yawDeviation = std::sqrt(covariance(kYaw, kYaw));
    found.levelDeviation = std::sqrt(levelSq);
    found.heightDeviation = std::sqrt(covariance(kMove + 1, kMove + 1));
  }

 private:
  std::span<const TrackedHead> heads_;
  const HeadsetPath& path_;
  Unknowns believed_, belief_;  ///< value, 1 / variance
  double scaleSq_ = 1.0;        ///< of Cauchy's loss [m^2]
  double noiseSq_ = 1.0;        ///< of one coordinate of one head, as if heads were independent [m^2]
};

}  // namespace

bool HeadsetPath::covers(double from, double to) const {
  const auto later = [](double time, const HeadsetPose& pose) { return time < pose.time; };
  auto pose = std::upper_bound(poses_.begin(), poses_.end(), from, later);
  if (poses_.size() < 2 || pose == poses_.begin()) return false;
  for (; pose != poses_.end(); ++pose) {
    if (pose->time - std::prev(pose)->time > kLongestGap) return false;
    if (pose->time >= to) return true;
  }
  return poses_.back().time >= to;  // all that is asked for is the last one
}

Isometry3 HeadsetPath::at(double time) const {
  const auto later = [](double when, const HeadsetPose& pose) { return when < pose.time; };
  const auto next = std::upper_bound(poses_.begin() + 1, poses_.end() - 1, time, later);
  const HeadsetPose &a = *std::prev(next), &b = *next;
  const double share = std::clamp((time - a.time) / (b.time - a.time), 0.0, 1.0);
  return Eigen::Translation3d(a.position + share * (b.position - a.position)) *
         a.orientation.slerp(share, b.orientation);
}

std::vector<TrackedHead> usable(std::span<const TrackedHead> heads, const HeadsetPath& path) {
  std::vector<TrackedHead> used;
  for (const TrackedHead& head : heads) {
    if (path.covers(head.time - kLongestLag - kSpeedStep, head.time + kSpeedStep)) used.push_back(head);
  }
  return used;
}

double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Registration coarseFit(std::span<const TrackedHead> heads, const HeadsetPath& path) {
  Unknowns best = Unknowns::Zero();
  double least = kInfinity;
  std::vector<Vec3> joints(heads.size());
  std::vector<double> weights(heads.size()), distances(heads.size()), sorted;
  for (int k = 0; k < kLags; ++k) {
    const double lag = k * kLagStep;
    for (std::size_t i = 0; i < heads.size(); ++i) joints[i] = path.at(heads[i].time - lag) * kNominalHeadInHeadset;
    std::fill(weights.begin(), weights.end(), 1.0);
    double yaw = 0.0;
    Vec3 move = Vec3::Zero();
    for (int round = 0; round < kReweighted; ++round) {
      double all = 0.0;
      Vec3 joint = Vec3::Zero(), seen = Vec3::Zero();
      for (std::size_t i = 0; i < heads.size(); ++i) {
        all += weights[i];
        joint += weights[i] * joints[i];
        seen += weights[i] * heads[i].position;
      }
      joint /= all;
      seen /= all;
      double across = 0.0, along = 0.0;
      for (std::size_t i = 0; i < heads.size(); ++i) {
        const Vec3 a = joints[i] - joint, b = heads[i].position - seen;
        across += weights[i] * (a.z() * b.x() - a.x() * b.z());
        along += weights[i] * (a.x() * b.x() + a.z() * b.z());
      }
      yaw = std::atan2(across, along);
      move = seen - turned(yaw, joint);
      for (std::size_t i = 0; i < heads.size(); ++i) {
        distances[i] = (turned(yaw, joints[i]) + move - heads[i].position).norm();
      }
      sorted = distances;
      const double scale = 1.5 * std::max(medianOf(sorted), 1e-3);
      for (std::size_t i = 0; i < heads.size(); ++i) weights[i] = 1.0 / (1.0 + std::pow(distances[i] / scale, 2));
    }
    double cost = 0.0;
    for (const double distance : distances) cost += std::log1p(std::pow(distance / kBadlyOff, 2));
    if (cost >= least) continue;
    least = cost;
    best << yaw, move, kNominalHeadInHeadset, lag;
  }
  return registrationOf(best);
}

Registration fineFit(std::span<const TrackedHead> heads, const HeadsetPath& path, const Registration& start) {
  Fit fit(heads, path);
  Unknowns x = unknownsOf(start);
  fit.measureNoise(x);
  for (int round = 0; round < kRounds; ++round) {
    fit.descend(x);
    fit.measureNoise(x);
  }
  Registration found = registrationOf(x);
  found.residual = fit.measureNoise(x);
  fit.judge(x, found);
  return found;
}

}  // namespace lorica::registration
