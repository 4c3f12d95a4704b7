#include "capture/registration/head_registration.h"

#include "capture/registration/registration_fit.h"
#include "geometry/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

constexpr std::size_t kMostHeads = 4096, kMostPoses = 16384;
constexpr double kFarthest = 1000.0;  ///< of a sample from the origin [m]
constexpr double kSetBack = 1.0;      ///< time that means another clock [s]

constexpr std::size_t kFewestHeads = 30;
constexpr double kMaxResidual = 0.1;  ///< of one and the same person [m]
constexpr double kMaxFloors = 0.15;   ///< between the two floors, by the nominal head [m]
constexpr double kMaxOffset = 0.12;   ///< of the head in the headset from the nominal one [m]
constexpr double kStanding = 0.15;    ///< root mean square distance from the mean place [m]
constexpr double kMaxLevel = 0.02;    ///< deviation that is said [m]

constexpr double kRecent = 2.0;  ///< [s]
constexpr std::size_t kFewestRecent = 15;
constexpr double kMoved = 0.05;  ///< [m]

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

/// The samples that are not more than some time before a moment.
template <typename Sample>
std::span<const Sample> since(const std::vector<Sample>& samples, double from) {
  const auto begin = std::lower_bound(samples.begin(), samples.end(), from,
                                      [](const Sample& sample, double time) { return sample.time < time; });
  return {begin, samples.end()};
}

/// Holds twice what is asked for, so that old samples are seldom moved out.
template <typename Sample>
void add(const Sample& sample, std::vector<Sample>& samples) {
  if (samples.size() == samples.capacity()) samples.erase(samples.begin(), samples.begin() + samples.size() / 2);
  samples.push_back(sample);
}

bool isPlace(const Vec3& position) {
  return position.allFinite() && position.cwiseAbs().maxCoeff() < kFarthest;
}

/// Root mean square distance of the heads from their mean place [m].
double spreadOf(std::span<const HeadRegistration::TrackedHead> heads) {
  Vec3 mean = Vec3::Zero();
  for (const auto& head : heads) mean += head.position / heads.size();
  double sum = 0.0;
  for (const auto& head : heads) sum += (head.position - mean).squaredNorm() / heads.size();
  return std::sqrt(sum);
}

}  // namespace

Isometry3 Registration::stageFromFloor() const {
  return Eigen::Translation3d(translation) * Eigen::AngleAxisd(yaw, Vec3::UnitY());
}

Vec3 Registration::headInFloor(const Vec3& position, const Quat& orientation) const {
  return stageFromFloor().inverse() * (position + orientation.normalized() * headInHeadset);
}

HeadRegistration::HeadRegistration() {
  heads_.reserve(2 * kMostHeads);
  poses_.reserve(2 * kMostPoses);
}

void HeadRegistration::addTracked(double time, const Vec3& head) {
  if (!std::isfinite(time) || !isPlace(head)) return;
  if (!heads_.empty() && time < heads_.back().time - kSetBack) restart();
  if (heads_.empty() || time > heads_.back().time) add({time, head}, heads_);
}

void HeadRegistration::addHeadset(double time, const Vec3& position, const Quat& orientation) {
  const double norm = orientation.norm();
  if (!std::isfinite(time) || !isPlace(position) || !(norm > 0.5 && norm < 2.0)) return;
  if (!poses_.empty() && time < poses_.back().time - kSetBack) restart();
  if (poses_.empty() || time > poses_.back().time) add({time, position, orientation.normalized()}, poses_);
}

void HeadRegistration::restart() {
  heads_.clear();
  poses_.clear();
}

Result<Registration> HeadRegistration::solve(const std::optional<Registration>& start) const {
  const double now = std::max(heads_.empty() ? 0.0 : heads_.back().time, poses_.empty() ? 0.0 : poses_.back().time);
  std::span<const TrackedHead> seen = since(heads_, now - kWindow);
  std::span<const HeadsetPose> posed = since(poses_, now - kWindow);
  if (seen.size() > kMostHeads) seen = seen.last(kMostHeads);
  if (posed.size() > kMostPoses) posed = posed.last(kMostPoses);
  const registration::HeadsetPath path(posed);
  const std::vector<TrackedHead> heads = registration::usable(seen, path);
  if (heads.size() < kFewestHeads) {
    return unsupported(
        "registration: {} of {} tracked heads have poses of the headset ({}) around their time, expected {}:"
        " walk where the camera sees you",
        heads.size(), seen.size(), posed.size(), kFewestHeads);
  }
  const Registration coarse = start ? *start : registration::coarseFit(heads, path);
  if (!(std::abs(coarse.translation.y()) < kMaxFloors)) {
    return unsupported(
        "registration: the floors of headset and camera are {:.2f} m apart, expected less than {}: set the"
        " headset's floor, and choose its stage or local-floor frame",
        std::abs(coarse.translation.y()), kMaxFloors);
  }
  const Registration found = registration::fineFit(heads, path, coarse);
  const double offset = (found.headInHeadset - kNominalHeadInHeadset).norm();
  if (!(found.residual < kMaxResidual) || !(offset < kMaxOffset)) {
    return unsupported(
        "registration: the tracked head is {:.2f} m (median) off the headset's path, expected less than {}, and"
        " {:.2f} m from the usual place in the headset, expected less than {}: only the one who wears the"
        " headset may be in view",
        found.residual, kMaxResidual, offset, kMaxOffset);
  }
  if (!(found.yawDeviation <= kMaxYawDeviation)) {
    return unsupported(
        "registration: the yaw is known to {:.2f} degrees, expected 1{}: walk a curve of two metres or more, look"
        " around",
        degrees(found.yawDeviation), spreadOf(heads) < kStanding ? ", because you stand still" : "");
  }
  return found;
}

bool HeadRegistration::hasMoved(const Registration& known) const {
  if (heads_.empty()) return false;
  const double from = heads_.back().time - kRecent;
  const registration::HeadsetPath path(since(poses_, from - 1.0));  // and what the lag needs
  std::array<std::vector<double>, 3> off;
  for (const TrackedHead& head : registration::usable(since(heads_, from), path)) {
    const Isometry3 pose = path.at(head.time - known.lag);
    const Vec3 apart = head.position - known.headInFloor(pose.translation(), Quat(pose.linear()));
    for (int k = 0; k < 3; ++k) off[k].push_back(apart[k]);
  }
  if (off[0].size() < kFewestRecent) return false;
  const Vec3 shift(registration::medianOf(off[0]), registration::medianOf(off[1]), registration::medianOf(off[2]));
  return shift.norm() > std::max(kMoved, 2.0 * known.residual) + 2.0 * known.levelDeviation;
}

std::string adviceFor(const Registration& registration) {
  if (registration.levelDeviation <= kMaxLevel) return "";
  return fmt::format("places are known to {:.0f} mm only: do not walk straight ahead alone, walk a curve, look around",
                     1000.0 * registration.levelDeviation);
}

bool facesAway(const Registration& registration, const Quat& orientation, const Vec3& facing) {
  // Of the headset's axes the one to the right stays level when the wearer looks up or down.
  const Vec3 ahead = Vec3::UnitY().cross(orientation * Vec3::UnitX());
  return ahead.dot(registration.stageFromFloor().linear() * facing) < 0.0;
}

}  // namespace lorica
