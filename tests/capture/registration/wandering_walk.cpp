#include "tests/capture/registration/wandering_walk.h"

#include "capture/files/joint_csv.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/random_numbers.h"

#include <cmath>
#include <numbers>

namespace lorica::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRate = 30.0;  // [Hz]

}  // namespace

std::vector<SkeletonFrame> wanderingWalk(double seconds, std::uint64_t seed, double room) {
  RandomNumbers random(seed);
  const std::vector<SkeletonFrame> steps = shippedFrames("walk");
  double heading = random.between(-kPi, kPi), turn = 0.0;
  Vec3 place = Vec3::Zero();
  std::vector<SkeletonFrame> frames;
  for (int f = 0; f < seconds * kRate; ++f) {
    SkeletonFrame frame = steps[f % steps.size()];
    const Vec3 hips = 0.5 * (frame[BodyJoint::kLeftHip].position + frame[BodyJoint::kRightHip].position);
    if (f % 20 == 0) turn = random.between(-1.2, 1.2);
    heading += turn / kRate;
    if (place.norm() > room) {
      heading += 2.5 / kRate * std::sin(std::remainder(std::atan2(-place.x(), -place.z()) - heading, 2.0 * kPi) / 2.0);
    }
    place += 0.8 / kRate * Vec3(std::sin(heading), 0.0, std::cos(heading));
    frame = moved(frame, Eigen::Translation3d(place) * Eigen::AngleAxisd(heading, Vec3::UnitY()) *
                             Eigen::Translation3d(-hips.x(), 0.0, -hips.z()));
    frame.time = f / kRate;
    Quat& head = *frame[BodyJoint::kHead].orientation;
    head = head * Eigen::AngleAxisd(0.5 * std::sin(1.7 * frame.time), Vec3::UnitY()) *
           Eigen::AngleAxisd(0.15 * std::sin(2.3 * frame.time), Vec3::UnitX());
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace lorica::test
