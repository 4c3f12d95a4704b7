#include "capture/registration/head_registration.h"

#include "capture/synthetic/synthetic_motion.h"
#include "capture/tracking/tracker.h"
#include "capture/virtual_sensor/virtual_body.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/registration/virtual_walk.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRate = 30.0;  // [Hz]
constexpr double kLag = 0.06;   // [s]

/// The walk on the spot, taken along curves in a small room, with a head that looks around.
std::vector<SkeletonFrame> wanderingWalk(double seconds, std::uint64_t seed) {
  RandomNumbers random(seed);
  const std::vector<SkeletonFrame> steps = synthesizeMotion(SyntheticMotion::kWalk);
  double heading = random.between(-kPi, kPi), turn = 0.0;
  Vec3 place = Vec3::Zero();
  std::vector<SkeletonFrame> frames;
  for (int f = 0; f < seconds * kRate; ++f) {
    SkeletonFrame frame = steps[f % steps.size()];
    const Vec3 hips = 0.5 * (frame[BodyJoint::kLeftHip].position + frame[BodyJoint::kRightHip].position);
    if (f % 20 == 0) turn = random.between(-1.2, 1.2);
    heading += turn / kRate;
    if (place.norm() > 0.8) {
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

// The tracker's own head joints, from noisy depth images, with a headset on the eyes of who is seen.
TEST(TrackedHead, OfADepthCameraRegistersAHeadset) {
  for (int seed = 1; seed <= 2; ++seed) {
    std::vector<VirtualPerson> people;
    people.push_back({VirtualPerformer::create(withProportions(makeMannequin(), {.height = 0.9 + 0.1 * seed}),
                                               wanderingWalk(10.0, seed))
                          .value()});
    people[0].worldFromMotion.translation().z() = 0.3;
    VirtualSensorSettings settings;
    settings.noise.seed = seed;
    VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
    Tracker tracker = Tracker::create(sensor.camera()).value();

    test::VirtualWalk walk({}, seed);  // of which the truth stays
    walk.truth.translation.y() = 0.0;
    walk.truth.headInHeadset = Vec3(0.0, -0.11, 0.1);
    walk.truth.lag = kLag;
    walk.heads.clear();
    walk.poses.clear();
    const Isometry3 stageFromFloor = walk.truth.stageFromFloor();
    DepthFrame frame;
    int facingAway = 0;
    for (std::uint64_t f = 0; f < sensor.frameCount(); ++f) {
      sensor.render(f, frame);
      const SkeletonFrame truth = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
      const Quat floorFromHeadset = *truth[BodyJoint::kHead].orientation * Quat(Eigen::AngleAxisd(kPi, Vec3::UnitY()));
      const Vec3 eyes = truth[BodyJoint::kHead].position - floorFromHeadset * walk.truth.headInHeadset;
      const Quat orientation(Mat3(stageFromFloor.linear() * floorFromHeadset.toRotationMatrix()));
      walk.poses.push_back({f / kRate, stageFromFloor * eyes, orientation});
      for (const TrackedPerson& person : tracker.track(frame)) {
        const SkeletonFrame& joints = person.skeleton;
        if (joints[BodyJoint::kHead].confidence < 0.5) continue;
        walk.heads.push_back({f / kRate + kLag, joints[BodyJoint::kHead].position});
        const Vec3 across = joints[BodyJoint::kLeftShoulder].position - joints[BodyJoint::kRightShoulder].position;
        facingAway += facesAway(walk.truth, orientation, across.cross(Vec3::UnitY())) ? 1 : 0;
      }
    }
    EXPECT_GT(walk.heads.size(), 250U);
    EXPECT_EQ(facingAway, 0);
    HeadRegistration registration;
    walk.walk(registration);
    const Registration found = test::valueOf(registration.solve());
    const test::RegistrationErrors errors = errorsOf(found, walk);
    EXPECT_LT(errors.yaw * 180.0 / kPi, 0.5) << seed;
    EXPECT_LT(errors.level, 0.01) << seed;
    EXPECT_LT(errors.height, 0.03) << seed;
    EXPECT_LT(errors.head, 0.02) << seed;
    EXPECT_LT(errors.lag, 0.02) << seed;
    EXPECT_FALSE(registration.hasMoved(found));
  }
}

}  // namespace
}  // namespace lorica
