#include "capture/registration/head_registration.h"

#include "capture/files/joint_csv.h"
#include "capture/registration/registration_file.h"
#include "capture/tracking/tracker.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/files.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/registration/virtual_walk.h"
#include "tests/capture/registration/wandering_walk.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRate = 30.0;  // [Hz]
constexpr double kLag = 0.06;   // [s]

// The tracker's own head joints, from noisy depth images, with a headset on the eyes of who is seen.
TEST(TrackedHead, OfADepthCameraRegistersAHeadset) {
  for (int seed = 1; seed <= 2; ++seed) {
    std::vector<VirtualPerson> people;
    people.push_back({VirtualPerformer::create(withProportions(makeMannequin(), {.height = 0.9 + 0.1 * seed}),
                                               test::wanderingWalk(10.0, seed))
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

WornHead wornBy(const SkeletonFrame& truth) {
  return {truth[BodyJoint::kHead].position, *truth[BodyJoint::kHead].orientation};
}

// A small room: a camera at the height of a knee, so near that it sees shins and feet alone.
TEST(TrackedHead, AHeadsetTellsOfABodyOfWhichOnlyTheFeetAreSeen) {
  VirtualSensorSettings settings;
  settings.noise.seed = 1;
  settings.room.worldFromCamera = worldFromCameraAt({0.0, 0.35, 1.6}, 0.25);
  struct Row {
    bool worn, lowerBody;
    int fewest, most;  // frames of 120 in which the person is tracked
  };
  for (const Row& row : {Row{false, false, 0, 0}, Row{true, false, 80, 120}, Row{true, true, 80, 120}}) {
    std::vector<VirtualPerson> people;
    people.push_back({VirtualPerformer::create(makeMannequin(), test::wanderingWalk(4.0, 1, 0.3)).value()});
    VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
    Tracker tracker = Tracker::create(sensor.camera(), {.lowerBody = row.lowerBody}).value();
    DepthFrame frame;
    int tracked = 0;
    double head = 0.0, feet = 0.0;
    for (std::uint64_t f = 0; f < sensor.frameCount(); ++f) {
      sensor.render(f, frame);
      const SkeletonFrame truth = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
      const auto found = tracker.track(frame, row.worn ? std::optional(wornBy(truth)) : std::nullopt);
      if (found.empty()) continue;
      ++tracked;
      const SkeletonFrame& joints = found[0].skeleton;
      const auto off = [&](BodyJoint joint) { return (joints[joint].position - truth[joint].position).norm(); };
      head += off(BodyJoint::kHead);
      feet += 0.5 * (off(BodyJoint::kLeftFoot) + off(BodyJoint::kRightFoot));
      // The camera does not claim to have seen the head: a registration must not learn from it.
      EXPECT_LT(joints[BodyJoint::kHead].confidence, 0.5);
      EXPECT_GE(joints[BodyJoint::kTorso].confidence, 0.5);
      EXPECT_EQ(joints[BodyJoint::kLeftHand].confidence == 0.0, row.lowerBody);
    }
    EXPECT_GE(tracked, row.fewest);
    EXPECT_LE(tracked, row.most);
    EXPECT_LE(head, 0.05 * tracked);
    EXPECT_LE(feet, 0.06 * tracked);
  }
}

// The same images: the body turns its front to where the headset looks.
TEST(TrackedHead, TheHeadsetDecidesFrontAndBack) {
  std::vector<VirtualPerson> people;
  people.push_back({VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value()});
  VirtualSensor sensor = VirtualSensor::create(std::move(people)).value();
  for (const bool turned : {false, true}) {
    Tracker tracker = Tracker::create(sensor.camera()).value();
    DepthFrame frame;
    for (int f = 0; f < 90; ++f) {
      sensor.render(f, frame);
      WornHead worn = wornBy(moved(sensor.truth()[0].joints, sensor.floorFromCamera()));
      // Turned about after a second: whoever is tracked is turned as well.
      if (turned && f >= 30) worn.orientation = Eigen::AngleAxisd(kPi, Vec3::UnitY()) * worn.orientation;
      const auto found = tracker.track(frame, worn);
      if (f < 80) continue;
      ASSERT_EQ(found.size(), 1U);
      const Vec3 front = *found[0].skeleton[BodyJoint::kTorso].orientation * Vec3::UnitZ();
      EXPECT_GT(front.dot(worn.ahead()), 0.5) << f;
    }
  }
}

Registration sample() {
  Registration registration;
  registration.yaw = -3.0 / 7.0;
  registration.translation = Vec3(1.0 / 3.0, -1e-17, -2.7182818284590452);
  registration.headInHeadset = Vec3(0.003, -0.07, 0.1);
  registration.lag = 0.0625;
  registration.residual = 0.026;
  registration.yawDeviation = 0.001;
  registration.levelDeviation = 0.004;
  registration.heightDeviation = 0.011;
  return registration;
}

TEST(RegistrationFile, IsReadAsItWasWritten) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "lorica" / "registrations" / "camera.json";
  EXPECT_EQ(loadRegistration(file).error().code, ErrorCode::kNotFound);
  Registration other = sample();
  other.lag = 0.1;
  ASSERT_TRUE(saveRegistration(file, other).ok());
  const Registration saved = sample();
  ASSERT_TRUE(saveRegistration(file, saved).ok()) << "the second replaces the first";
  const Registration loaded = test::valueOf(loadRegistration(file));
  EXPECT_EQ(loaded.yaw, saved.yaw);
  EXPECT_EQ(loaded.translation, saved.translation);
  EXPECT_EQ(loaded.headInHeadset, saved.headInHeadset);
  EXPECT_EQ(loaded.lag, saved.lag);
  EXPECT_EQ(loaded.residual, saved.residual);
  EXPECT_EQ(loaded.yawDeviation, saved.yawDeviation);
  EXPECT_EQ(loaded.levelDeviation, saved.levelDeviation);
  EXPECT_EQ(loaded.heightDeviation, saved.heightDeviation);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file.parent_path()), {}), 1) << "nothing is left beside";
}

TEST(RegistrationFile, WhatCannotBeIsASentence) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "lorica" / "camera.json";
  ASSERT_TRUE(saveRegistration(file, sample()).ok());
  const std::string fine = test::valueOf(readFile(file));
  const auto refusal = [&](const std::string& text) {
    const std::filesystem::path damaged = folder.write("damaged.json", text);
    const Result<Registration> loaded = loadRegistration(damaged);
    EXPECT_FALSE(loaded.ok()) << text;
    if (loaded.ok()) return std::string();
    EXPECT_TRUE(test::has(loaded.error().message, damaged.string()));
    return loaded.error().message;
  };
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string text = fine;
    EXPECT_NE(text.find(from), std::string::npos) << from;
    return text.replace(text.find(from), from.size(), to);
  };
  test::expectAll(refusal(with("lorica registration 1", "lorica registration 2")), {"format", "found", "expected"});
  test::expectAll(refusal(with("0.0625", "0.4")), {"lag: found 0.4, expected a number from 0 to 0.2"});
  test::expectAll(refusal(with("0.0625", "\"soon\"")), {"lag: found \"soon\""});
  test::expectAll(refusal(with("\"lag\"", "\"log\"")), {"lag: found null"});
  test::expectAll(refusal(with("-2.718281828459045", "-27182.0")), {"translation: found", "three numbers from -10000"});
  test::expectAll(refusal(with("-2.718281828459045", "[]")), {"translation: found"});
  test::expectAll(refusal(with("\"yaw\"", "\"more\": 1, \"yaw\"")), {"found 10 entries, expected 9"});
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string("null"), std::string("7"), std::string("\xff\xfe"),
        with("0.0625", "NaN"), with("0.0625", "1e999"), with("0.0625", "-1e-9"), with("0.0625", "null"),
        with("0.001", "0.5"), with("-2.718281828459045", "1, 2"), std::string(1000, '['), fine + fine}) {
    EXPECT_NE(refusal(text), "");
  }
  for (std::size_t length = 0; length + 2 < fine.size(); ++length) refusal(fine.substr(0, length));
  test::expectAll(refusal(fine + std::string(1 << 20, ' ')), {"1048904 bytes, expected at most 65536"});
  EXPECT_FALSE(loadRegistration(folder.path()).ok()) << "a folder";
  EXPECT_FALSE(saveRegistration(folder.path() / "damaged.json" / "camera.json", sample()).ok())
      << "a file is no folder";
}

TEST(RegistrationFile, EachCameraHasOneInTheUsersConfigurationFolder) {
  const char* before = std::getenv("XDG_CONFIG_HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("XDG_CONFIG_HOME", "/somewhere", 1);
  const std::filesystem::path file = registrationFile("usb:/../1-2");
  EXPECT_EQ(file.parent_path(), "/somewhere/lorica/registrations");
  EXPECT_EQ(file.extension(), ".json");
  EXPECT_EQ(registrationFile("usb:/../1-2"), file);
  EXPECT_NE(registrationFile("usb:/../1-3"), file);
  setenv("XDG_CONFIG_HOME", "relative", 1);
  setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(registrationFile("").parent_path(), "/home/someone/.config/lorica/registrations");
  setenv("XDG_CONFIG_HOME", kept.c_str(), 1);
}

}  // namespace
}  // namespace lorica
