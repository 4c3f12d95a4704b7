#include "tests/capture/registration/virtual_walk.h"

#include "geometry/random_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lorica::test {
namespace {

using Shape = WalkSettings::Shape;

constexpr double kPi = std::numbers::pi;
constexpr int kRate = 360;            ///< of the true path [Hz]
constexpr int kHeadsetEvery = 5;      ///< 72 Hz
constexpr double kCameraRate = 30.0;  ///< [Hz]
constexpr double kSteps = 1.9;        ///< of the walk [Hz]

class Normal {
 public:
  explicit Normal(std::uint64_t seed) : random_(seed) {}
  double operator()(double deviation) {
    return deviation * std::sqrt(-2.0 * std::log(1.0 - random_.unit())) * std::cos(2.0 * kPi * random_.unit());
  }
  Vec3 vector(double deviation) {
    const double x = (*this)(deviation), y = (*this)(deviation);
    return {x, y, (*this)(deviation)};
  }
  double between(double min, double max) { return random_.between(min, max); }

 private:
  RandomNumbers random_;
};

/// A smooth curve through random numbers.
class Wander {
 public:
  /// @param every  [s] between the numbers
  Wander(Normal& normal, double seconds, double every, double deviation) : every_(every) {
    for (int k = 0; k < seconds / every + 5; ++k) knots_.push_back(normal(deviation));
  }
  [[nodiscard]] double at(double time) const {
    const auto k = static_cast<std::size_t>(time / every_);
    const double u = time / every_ - k;
    const double a = knots_[k], b = knots_[k + 1], c = knots_[k + 2], d = knots_[k + 3];
    return b + 0.5 * u * (c - a + u * (2.0 * a - 5.0 * b + 4.0 * c - d + u * (3.0 * (b - c) + d - a)));
  }

 private:
  double every_;
  std::vector<double> knots_;
};

/// The headset's true path in the floor frame.
std::vector<HeadRegistration::HeadsetPose> truePath(const WalkSettings& settings, Normal& normal) {
  const double seconds = settings.seconds + 0.5;
  const bool walks = settings.shape == Shape::kWander || settings.shape == Shape::kLine;
  const bool wanders = settings.shape == Shape::kWander;
  const Wander course(normal, seconds, 0.8, wanders ? 1.2 : 0.0), swayX(normal, seconds, 0.6, 0.008),
      swayZ(normal, seconds, 0.6, 0.008), bob(normal, seconds, 0.7, 0.004),
      look(normal, seconds, 0.7, settings.shape == Shape::kLine ? 0.05 : 0.25),
      nod(normal, seconds, 0.6, wanders ? 0.15 : 0.04), tilt(normal, seconds, 0.6, wanders ? 0.06 : 0.02);
  double heading = normal.between(-kPi, kPi);
  Vec3 place = Vec3::Zero();
  std::vector<HeadRegistration::HeadsetPose> path;
  for (int i = 0; i < seconds * kRate; ++i) {
    const double time = 1.0 * i / kRate;
    heading += course.at(time) / kRate;
    double speed = walks ? settings.distance / settings.seconds : 0.0;
    if (settings.shape == Shape::kLine && std::sin(2.0 * kPi * time / settings.seconds + 0.3) < 0.0) speed = -speed;
    const Vec3 ahead(-std::sin(heading), 0.0, -std::cos(heading));
    if (place.norm() > settings.room) {
      heading += 3.0 / kRate * std::sin(std::remainder(std::atan2(place.x(), place.z()) - heading, 2.0 * kPi) / 2.0);
    }
    place += speed / kRate * ahead;
    const double gait = 2.0 * kPi * kSteps * time;
    const double lean = walks ? 0.015 * std::sin(0.5 * gait) : 0.0;
    const double height = 1.65 + bob.at(time) + (walks ? 0.02 * std::sin(gait) : 0.0);
    double yaw = heading + look.at(time), pitch = nod.at(time);
    if (settings.shape == Shape::kTurnHead) yaw = heading + 1.2 * std::sin(2.0 * kPi * time / 2.5);
    if (settings.shape == Shape::kTurnAndNod) {
      yaw = heading + std::sin(2.0 * kPi * time / 3.0);
      pitch += 0.5 * std::sin(kPi * time);
    }
    path.push_back({time, place + Vec3(swayX.at(time), height, swayZ.at(time)) + lean * ahead.cross(Vec3::UnitY()),
                    Eigen::AngleAxisd(yaw, Vec3::UnitY()) * Eigen::AngleAxisd(pitch, Vec3::UnitX()) *
                        Eigen::AngleAxisd(tilt.at(time), Vec3::UnitZ())});
  }
  return path;
}

}  // namespace

VirtualWalk::VirtualWalk(const WalkSettings& settings, std::uint64_t seed) {
  Normal normal(seed);
  const auto path = truePath(settings, normal);
  truth.yaw = normal.between(-kPi, kPi);
  truth.translation = Vec3(normal.between(-2.0, 2.0), normal(0.01), normal.between(-2.0, 2.0));
  truth.headInHeadset = settings.head + normal.vector(0.02);
  truth.lag = settings.lag;

  const Isometry3 stageFromFloor = truth.stageFromFloor();
  for (std::size_t i = 0; i < path.size(); i += kHeadsetEvery) {
    const Vec3 drift(settings.drift * path[i].time / settings.seconds, 0.0, 0.0);
    poses.push_back({path[i].time, stageFromFloor * path[i].position + drift,
                     Quat(stageFromFloor.linear() * path[i].orientation.toRotationMatrix())});
  }

  const auto jointAt = [&](double time) -> Vec3 {
    const auto i = std::min(static_cast<std::size_t>(time * kRate), path.size() - 2);
    const auto joint = [&](std::size_t k) -> Vec3 {
      return path[k].position + path[k].orientation * truth.headInHeadset;
    };
    return joint(i) + (time * kRate - i) * (joint(i + 1) - joint(i));
  };
  const double lasting = settings.lasting;
  const Vec3 deviation = settings.noise / std::sqrt(1.0 + 0.96 * lasting) * Vec3(1.0, 1.0, 1.4);
  Vec3 noise = normal.vector(1.0), before = noise;
  int lost = 0;
  for (int k = 0; settings.lag + 0.05 + k / kCameraRate < settings.seconds; ++k) {
    const double time = settings.lag + 0.05 + k / kCameraRate + normal(0.002);
    Vec3 head = jointAt(time - settings.lag) + deviation.cwiseProduct(noise);
    const Vec3 fresh = normal.vector(1.0);
    noise = lasting * noise + std::sqrt(1.0 - lasting * lasting) * (0.6 * before + 0.8 * fresh);
    before = fresh;
    if (normal.between(0.0, 1.0) < settings.outliers) head += normal.vector(0.2);
    if (lost == 0 && normal.between(0.0, 1.0) < 0.2 * settings.dropouts) {
      lost = static_cast<int>(normal.between(2.0, 9.0));
    }
    if (lost > 0)
      --lost;
    else
      heads.push_back({time, head});
  }
}

void VirtualWalk::walk(HeadRegistration& registration) const {
  std::size_t next = 0;
  for (const auto& pose : poses) {
    for (; next < heads.size() && heads[next].time < pose.time; ++next) {
      registration.addTracked(heads[next].time, heads[next].position);
    }
    registration.addHeadset(pose.time, pose.position, pose.orientation);
  }
}

RegistrationErrors errorsOf(const Registration& found, const VirtualWalk& walk) {
  const Isometry3 is = walk.truth.stageFromFloor().inverse(), said = found.stageFromFloor().inverse();
  double levelSq = 0.0, heightSq = 0.0, headSq = 0.0;
  for (const auto& pose : walk.poses) {
    const Vec3 off = said * pose.position - is * pose.position;
    levelSq += off.x() * off.x() + off.z() * off.z();
    heightSq += off.y() * off.y();
    headSq +=
        (found.headInFloor(pose.position, pose.orientation) - walk.truth.headInFloor(pose.position, pose.orientation))
            .squaredNorm();
  }
  const auto mean = [&](double sum) { return std::sqrt(sum / walk.poses.size()); };
  return {std::abs(std::remainder(found.yaw - walk.truth.yaw, 2.0 * kPi)), mean(levelSq), mean(heightSq), mean(headSq),
          std::abs(found.lag - walk.truth.lag)};
}

}  // namespace lorica::test
