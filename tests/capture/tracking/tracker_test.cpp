#include "capture/tracking/tracker.h"

#include "capture/files/joint_stream.h"
#include "capture/synthetic/synthetic_motion.h"
#include "capture/virtual_sensor/virtual_body.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numbers>
#include <vector>

namespace lorica {
namespace {

VirtualSensor sensorBefore(SyntheticMotion motion, double heading, std::uint64_t seed,
                           const BodyProportions& proportions = {}, std::vector<TimeSpan> absent = {}) {
  std::vector<VirtualPerson> people;
  people.push_back(
      {VirtualPerformer::create(withProportions(makeMannequin(), proportions), synthesizeMotion(motion)).value()});
  people[0].worldFromMotion.linear() = Eigen::AngleAxisd(heading, Vec3::UnitY()).toRotationMatrix();
  people[0].absent = std::move(absent);
  VirtualSensorSettings settings;
  if (seed == 0) {
    settings.noise = DepthNoiseSettings::clean();
  } else {
    settings.noise.seed = seed;
  }
  return VirtualSensor::create(std::move(people), settings).value();
}

struct Figures {
  int tracked = 0;
  double mean = 0.0;  ///< of all joints and frames [m]
  int badFrames = 0;  ///< some limb joint off by more than 0.15 m
  int trustedWrong = 0, trusted = 0;
  std::vector<SkeletonFrame> joints;
};

Figures follow(VirtualSensor& sensor, int frames, int from = 0) {
  Tracker tracker = Tracker::create(sensor.camera()).value();
  Figures figures;
  DepthFrame frame;
  double sum = 0.0;
  for (int f = from; f < from + frames; ++f) {
    sensor.render(static_cast<std::uint64_t>(f), frame);
    const auto people = tracker.track(frame);
    if (people.size() != 1 || !sensor.truth()[0].present) continue;
    const SkeletonFrame truth = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
    ++figures.tracked;
    figures.joints.push_back(people[0].skeleton);
    bool bad = false;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint& joint = people[0].skeleton.joints[j];
      const double off = (joint.position - truth.joints[j].position).norm();
      sum += off;
      bad = bad || off > 0.15;
      figures.trusted += joint.confidence >= 0.5 ? 1 : 0;
      figures.trustedWrong += joint.confidence >= 0.5 && off > 0.15 ? 1 : 0;
    }
    figures.badFrames += bad ? 1 : 0;
  }
  figures.mean = sum / std::max(1, figures.tracked * kBodyJointCount);
  return figures;
}

TEST(Tracker, RefusesWhatItCannotDo) {
  EXPECT_FALSE(Tracker::create(DepthCamera{}, {.maxPeople = 0}).ok());
  EXPECT_FALSE(Tracker::create(DepthCamera{}, {.maxPeople = 7}).ok());
  DepthCamera tiny;
  tiny.width = 8;
  EXPECT_FALSE(Tracker::create(tiny).ok());
  DepthCamera flat;
  flat.verticalFov = 0.0;
  EXPECT_FALSE(Tracker::create(flat).ok());
}

TEST(Tracker, SeesNobodyInAnEmptyImageOrOneOfAnotherSize) {
  Tracker tracker = Tracker::create(DepthCamera{}).value();
  DepthFrame frame;
  EXPECT_TRUE(tracker.track(frame).empty());
  frame.depthMm.assign(640 * 480, 0);
  EXPECT_TRUE(tracker.track(frame).empty());
  frame.depthMm.assign(640 * 480, 3000);
  for (int i = 0; i < 5; ++i) {
    frame.time = 0.1 + i / 30.0;
    EXPECT_TRUE(tracker.track(frame).empty());
  }
}

TEST(Tracker, FollowsJumpingJacksOfATallerBodyThroughNoise) {
  VirtualSensor sensor = sensorBefore(SyntheticMotion::kJumpingJacks, 0.0, 7, {.height = 1.1});
  const Figures figures = follow(sensor, 50);
  EXPECT_GE(figures.tracked, 35);
  EXPECT_LT(figures.mean, 0.035);
  EXPECT_LE(figures.badFrames, 2);
  EXPECT_LE(figures.trustedWrong * 50, figures.trusted);
}

TEST(Tracker, BlurredEdgesDoNotMakeABodyLarger) {
  std::vector<VirtualPerson> people;
  people.push_back({VirtualPerformer::create(makeMannequin(), synthesizeMotion(SyntheticMotion::kWave)).value()});
  VirtualSensorSettings settings;
  settings.noise = DepthNoiseSettings::realSense();
  settings.camera = settings.noise.sensor;
  VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
  Tracker tracker = Tracker::create(sensor.camera()).value();
  DepthFrame frame;
  int tracked = 0;
  double height = 0.0;
  for (std::uint64_t f = 0; f < 60; ++f) {
    sensor.render(f, frame);
    for (const TrackedPerson& person : tracker.track(frame)) {
      ++tracked;
      height = person.height;
    }
  }
  EXPECT_GT(tracked, 30);
  EXPECT_NEAR(height, 1.752, 0.09);
}

TEST(Tracker, TellsABackFromAFront) {
  VirtualSensor sensor = sensorBefore(SyntheticMotion::kWave, std::numbers::pi, 0);
  const Figures figures = follow(sensor, 30);
  EXPECT_GE(figures.tracked, 15);
  EXPECT_LT(figures.mean, 0.035);  // left and right swapped would give 0.3
  // The chest faces away from the camera, which looks along -Z.
  const Quat chest = *figures.joints.back()[BodyJoint::kTorso].orientation;
  EXPECT_LT((chest * Vec3::UnitZ()).z(), -0.9);
}

TEST(Tracker, GoesOnAfterAPersonWasHidden) {
  VirtualSensor sensor = sensorBefore(SyntheticMotion::kJumpingJacks, 0.0, 3, {}, {{0.8, 1.8}});
  Tracker tracker = Tracker::create(sensor.camera()).value();
  DepthFrame frame;
  int wrong = 0;
  int seen = 0;
  for (int f = 0; f < 85; ++f) {
    sensor.render(static_cast<std::uint64_t>(f), frame);
    const auto people = tracker.track(frame);
    if (!sensor.truth()[0].present) continue;
    if (f < 54 + 15) continue;  // half a second after coming back
    const SkeletonFrame truth = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
    ASSERT_EQ(people.size(), 1u) << "frame " << f;
    ++seen;
    double worst = 0.0;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      worst = std::max(worst, (people[0].skeleton.joints[j].position - truth.joints[j].position).norm());
    }
    wrong += worst > 0.15 ? 1 : 0;
  }
  EXPECT_GT(seen, 10);
  EXPECT_LE(wrong, 1);
}

TEST(Tracker, FramesTakeNoMemory) {
  // A person is tracked, searched for, lost and found again: none of this allocates per frame.
  VirtualSensor sensor = sensorBefore(SyntheticMotion::kJumpingJacks, 0.0, 4, {}, {{0.5, 1.0}});
  Tracker tracker = Tracker::create(sensor.camera()).value();
  DepthFrame frame;
  std::size_t seen = 0;
  for (int f = 0; f < 45; ++f) {
    sensor.render(static_cast<std::uint64_t>(f), frame);
    const long before = test::allocationCount();
    seen += tracker.track(frame).size();
    if (f > 0) {
      EXPECT_EQ(test::allocationCount(), before) << "frame " << f;
    }
  }
  EXPECT_GT(seen, 18U);
}

TEST(Tracker, SameFramesGiveTheSameBits) {
  VirtualSensor sensor = sensorBefore(SyntheticMotion::kPunchAndKick, 0.0, 2);
  const Figures a = follow(sensor, 18);
  const Figures b = follow(sensor, 18);
  ASSERT_EQ(a.joints.size(), b.joints.size());
  ASSERT_FALSE(a.joints.empty());
  for (std::size_t f = 0; f < a.joints.size(); ++f) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const Vec3& p = a.joints[f].joints[j].position;
      const Vec3& q = b.joints[f].joints[j].position;
      EXPECT_EQ(0, std::memcmp(p.data(), q.data(), 3 * sizeof(double)));
    }
  }
}

TEST(Tracker, JointsOfAPersonCutByTheImageAreNotTrusted) {
  // So near that the legs are below the image.
  std::vector<VirtualPerson> people;
  people.push_back({VirtualPerformer::create(makeMannequin(), synthesizeMotion(SyntheticMotion::kWave)).value()});
  people[0].worldFromMotion.translation() = Vec3(0.0, 0.0, 1.5);
  VirtualSensorSettings settings;
  settings.noise = DepthNoiseSettings::clean();
  VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
  const Figures figures = follow(sensor, 30);
  ASSERT_GE(figures.tracked, 10);
  const SkeletonFrame& last = figures.joints.back();
  EXPECT_LT(last[BodyJoint::kLeftFoot].confidence, 0.5);
  EXPECT_LT(last[BodyJoint::kRightFoot].confidence, 0.5);
  EXPECT_LE(figures.trustedWrong * 20, figures.trusted);
}

}  // namespace
}  // namespace lorica
