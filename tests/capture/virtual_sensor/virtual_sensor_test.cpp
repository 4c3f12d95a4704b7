#include "capture/virtual_sensor/virtual_sensor.h"

#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "capture/retarget/skeletal_retarget.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace lorica {
namespace {

using J = BodyJoint;

const VirtualPerformer& waving() {
  static const VirtualPerformer performer = VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value();
  return performer;
}

VirtualSensor sensorOf(std::vector<VirtualPerson> people, const VirtualSensorSettings& settings) {
  return VirtualSensor::create(std::move(people), settings).value();
}

VirtualSensorSettings cleanSettings() {
  VirtualSensorSettings settings;
  settings.noise = DepthNoiseSettings::clean();
  return settings;
}

struct Pixel {
  int column, row;
  [[nodiscard]] std::size_t in(const DepthCamera& camera) const {
    return static_cast<std::size_t>(row * camera.width + column);
  }
};
Pixel pixelOf(const DepthCamera& camera, const Vec3& position) {
  const Eigen::Vector2d point = camera.imagePointOf(position);
  return {static_cast<int>(std::floor(point.x())), static_cast<int>(std::floor(point.y()))};
}

TEST(VirtualSensor, JointsLieBehindTheSurfaceThatIsSeenOfThem) {
  VirtualSensor sensor = sensorOf({{waving()}}, cleanSettings());
  DepthFrame frame;
  int compared = 0;
  for (std::uint64_t f = 0; f < sensor.frameCount(); f += 10) {
    sensor.render(f, frame);
    const VirtualTruth& truth = sensor.truth()[0];
    ASSERT_TRUE(truth.present);
    ASSERT_GT(truth.pixelCount, 15000);
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint& joint = truth.joints.joints[j];
      ASSERT_EQ(joint.confidence, 1.0);
      const std::size_t at = pixelOf(sensor.camera(), joint.position).in(sensor.camera());
      ASSERT_EQ(sensor.labels()[at], 1) << "frame " << f << ", " << nameOf(static_cast<J>(j));
      const double behind = -joint.position.z() - 0.001 * frame.depthMm[at];
      ASSERT_GT(behind, -0.001) << "frame " << f << ", " << nameOf(static_cast<J>(j));
      if (behind < 0.3) ++compared;  // otherwise something in front of the joint hides it
    }
  }
  EXPECT_GT(compared, 28 * kBodyJointCount);
}

TEST(VirtualSensor, TruthIsTheMotionsOwnJoints) {
  const Character character = makeMannequin();
  const std::vector<SkeletonFrame> recording = shippedFrames("turn_around");
  VirtualPerformer performer = VirtualPerformer::create(character, recording).value();
  SkeletalMotion motion{"", character.skeleton, {}, {}};
  Retargeter retargeter = Retargeter::create(character.skeleton).value();
  Pose pose = restPose(character.skeleton);
  for (const SkeletonFrame& frame : recording) {
    retargeter.apply(frame, pose);
    motion.times.push_back(frame.time);
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  const std::vector<SkeletonFrame> expected = bodyJointsOf(motion).value();
  const Isometry3 cameraFromWorld = worldFromCameraAt({0.3, 1.0, 3.0}, 0.1, 0.2).inverse();
  for (std::size_t f = 0; f < recording.size(); f += 7) {
    performer.pose(recording[f].time - recording[0].time, cameraFromWorld);
    const SkeletonFrame joints = moved(performer.joints(), cameraFromWorld.inverse());
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      ASSERT_NEAR((joints.joints[j].position - expected[f].joints[j].position).norm(), 0.0, 1e-9);
      ASSERT_TRUE(joints.joints[j].orientation.has_value());
      ASSERT_LT(joints.joints[j].orientation->angularDistance(*expected[f].joints[j].orientation), 1e-6);
    }
  }
}

TEST(VirtualSensor, TheSurfaceIsTheSkinnedMesh) {
  // Clean depth of the wave's first frame, transformed back to the world, is on the floor, on the wall or near the
  // mesh.
  VirtualSensor sensor = sensorOf({{waving()}}, cleanSettings());
  DepthFrame frame;
  sensor.render(0, frame);
  VirtualPerformer performer = waving();
  performer.pose(0.0, Isometry3::Identity());
  const Aabb bounds = boundsOf(performer.positions());
  Aabb seen;
  for (int row = 0; row < 480; ++row) {
    for (int column = 0; column < 640; ++column) {
      const std::size_t at = Pixel{column, row}.in(sensor.camera());
      if (sensor.labels()[at] != 1) continue;
      const Vec3 inCamera = sensor.camera().positionOf(column, row, 0.001 * frame.depthMm[at]);
      seen.extend(VirtualRoom{}.worldFromCamera * inCamera);
    }
  }
  // A pixel is 5 mm wide at 3 m. The back is not visible.
  EXPECT_NEAR(seen.min.x(), bounds.min.x(), 0.008);
  EXPECT_NEAR(seen.max.x(), bounds.max.x(), 0.008);
  EXPECT_NEAR(seen.min.y(), bounds.min.y(), 0.008);
  EXPECT_NEAR(seen.max.y(), bounds.max.y(), 0.008);
  EXPECT_NEAR(seen.max.z(), bounds.max.z(), 0.03);
  EXPECT_GE(seen.min.z(), bounds.min.z());
}

TEST(VirtualSensor, TheFloorFrameStandsBelowTheCameraAndLooksWithIt) {
  VirtualSensorSettings settings = cleanSettings();
  settings.room.worldFromCamera = worldFromCameraAt({0.7, 1.4, 2.5}, 0.3, 0.4);
  VirtualSensor sensor = sensorOf({{waving()}}, settings);
  const Isometry3& floorFromCamera = sensor.floorFromCamera();
  EXPECT_NEAR((floorFromCamera.translation() - Vec3(0.0, 1.4, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((floorFromCamera.linear() * Vec3(0.0, 0.0, -1.0) - Vec3(0.0, -std::sin(0.3), -std::cos(0.3))).norm(), 0.0,
              1e-12);
  DepthFrame frame;
  sensor.render(0, frame);
  const Vec3 corner = floorFromCamera * sensor.camera().positionOf(5, 470, 0.001 * frame.depthMm[470 * 640 + 5]);
  EXPECT_NEAR(corner.y(), 0.0, 0.001);
  const SkeletonFrame joints = moved(sensor.truth()[0].joints, floorFromCamera);
  EXPECT_NEAR(joints[J::kHead].position.y(), 1.55, 0.1);
  EXPECT_LT(joints[J::kLeftFoot].position.y(), 0.12);
}

TEST(VirtualSensor, FramesComeOnceInOrderAndEnd) {
  VirtualSensorSettings settings = cleanSettings();
  settings.camera.width = 64;
  settings.camera.height = 48;
  VirtualSensor sensor = sensorOf({{waving()}}, settings);
  EXPECT_EQ(sensor.frameCount(), 301U);
  DepthFrame frame;
  std::uint64_t count = 0;
  Result<DepthRead> read = sensor.next(frame);
  for (; read.value() == DepthRead::kFrame; read = sensor.next(frame), ++count) {
    ASSERT_DOUBLE_EQ(frame.time, static_cast<double>(count) / 30.0);
    ASSERT_EQ(frame.depthMm.size(), 64U * 48U);
  }
  EXPECT_EQ(read.value(), DepthRead::kEnd);
  EXPECT_EQ(count, 301U);
  settings.loop = true;
  VirtualSensor looping = sensorOf({{waving()}}, settings);
  for (int i = 0; i < 400; ++i) ASSERT_EQ(looping.next(frame).value(), DepthRead::kFrame);
  const SkeletonFrame late = looping.truth()[0].joints;
  looping.render(99, frame);
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    ASSERT_NEAR((late.joints[j].position - looping.truth()[0].joints.joints[j].position).norm(), 0.0, 1e-9);
  }
}

TEST(VirtualSensor, TheSameSettingsGiveTheSameFramesAndAnotherSeedOthers) {
  VirtualSensorSettings settings;
  VirtualSensor one = sensorOf({{waving()}}, settings);
  VirtualSensor same = sensorOf({{waving()}}, settings);
  settings.noise.seed = 7;
  VirtualSensor other = sensorOf({{waving()}}, settings);
  DepthFrame a, b, c;
  same.render(17, b);
  for (const std::uint64_t number : {5U, 6U}) {
    one.render(number, a);
    same.render(number, b);
    other.render(number, c);
    EXPECT_EQ(a.depthMm, b.depthMm);
    EXPECT_NE(a.depthMm, c.depthMm);
  }
}

TEST(VirtualSensor, UnpluggedItSaysSoAndComesBack) {
  VirtualSensorSettings settings = cleanSettings();
  settings.camera.width = 64;
  settings.camera.height = 48;
  settings.unplugged = {{1.0, 2.0}};
  VirtualSensor sensor = sensorOf({{waving()}}, settings);
  DepthFrame frame;
  for (int i = 0; i < 30; ++i) ASSERT_EQ(sensor.next(frame).value(), DepthRead::kFrame);
  for (int i = 0; i < 30; ++i) ASSERT_EQ(sensor.next(frame).value(), DepthRead::kUnplugged);
  ASSERT_EQ(sensor.next(frame).value(), DepthRead::kFrame);
  EXPECT_DOUBLE_EQ(frame.time, 2.0);
}

TEST(VirtualSensor, PeopleLeaveAndReturnAndHideBehindScreens) {
  VirtualSensorSettings settings = cleanSettings();
  settings.screens = {{{Vec3(-1.5, 0.0, 0.9), Vec3(1.5, 2.5, 1.0)}, {6.0, 7.0}}};
  VirtualPerson vanishing{waving()};
  vanishing.absent = {{1.0, 2.0}};
  VirtualPerson leaving{waving()};
  leaving.worldFromMotion.translate(Vec3(0.9, 0.0, 0.0));
  leaving.absent = {{2.0, 5.0}};
  leaving.leaveSpeed = 1.5;
  VirtualSensor sensor = sensorOf({vanishing, leaving}, settings);
  DepthFrame frame;
  const auto pixels = [&](double time, std::size_t person) {
    sensor.render(static_cast<std::uint64_t>(std::lround(30.0 * time)), frame);
    return sensor.truth()[person].pixelCount;
  };
  EXPECT_GT(pixels(0.9, 0), 15000);
  EXPECT_EQ(pixels(1.0, 0), 0);
  EXPECT_FALSE(sensor.truth()[0].present);
  EXPECT_GT(pixels(2.0, 0), 15000);
  EXPECT_GT(pixels(1.9, 1), 15000);
  EXPECT_EQ(pixels(3.5, 1), 0);
  EXPECT_TRUE(sensor.truth()[1].present);
  EXPECT_GT(sensor.truth()[1].joints[J::kTorso].position.x(), 2.5);
  EXPECT_GT(pixels(5.0, 1), 15000);
  EXPECT_GT(pixels(5.9, 0), 15000);
  EXPECT_LT(pixels(6.5, 0), 500);
  EXPECT_GT(pixels(7.0, 0), 15000);
}

TEST(VirtualSensor, LiveFramesAreNeverEarlyAndRise) {
  VirtualSensorSettings settings = cleanSettings();
  settings.camera.width = 64;
  settings.camera.height = 48;
  settings.framesPerSecond = 60.0;
  settings.live = settings.loop = true;
  VirtualSensor sensor = sensorOf({{waving()}}, settings);
  DepthFrame frame;
  double last = -1.0;
  const auto begin = std::chrono::steady_clock::now();
  for (int frames = 0; frames < 10;) {
    const DepthRead read = sensor.next(frame).value();
    ASSERT_TRUE(read == DepthRead::kFrame || read == DepthRead::kWaiting);
    if (read == DepthRead::kWaiting) continue;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    ASSERT_LE(frame.time, passed.count());
    ASSERT_GT(frame.time, last);
    last = frame.time;
    ++frames;
  }
}

TEST(VirtualSensor, AFrameAllocatesNothing) {
  VirtualSensor sensor = sensorOf({{waving()}, {waving()}}, {});
  DepthFrame frame;
  ASSERT_EQ(sensor.next(frame).value(), DepthRead::kFrame);
  const long before = test::allocationCount();
  for (int i = 0; i < 3; ++i) ASSERT_EQ(sensor.next(frame).value(), DepthRead::kFrame);
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(VirtualSensor, SettingsOutOfRangeAreRefused) {
  const auto refused = [](auto change) {
    VirtualSensorSettings settings;
    change(settings);
    const Result<VirtualSensor> made = VirtualSensor::create({}, settings);
    return !made && made.error().code == ErrorCode::kInvalidArgument && !made.error().message.empty();
  };
  EXPECT_FALSE(refused([](VirtualSensorSettings&) {}));
  EXPECT_TRUE(refused([](VirtualSensorSettings& s) { s.camera.width = 0; }));
  EXPECT_TRUE(refused([](VirtualSensorSettings& s) { s.camera.height = 1 << 20; }));
  EXPECT_TRUE(refused([](VirtualSensorSettings& s) { s.camera.horizontalFov = std::nan(""); }));
  EXPECT_TRUE(refused([](VirtualSensorSettings& s) { s.framesPerSecond = 0.0; }));
  EXPECT_TRUE(refused([](VirtualSensorSettings& s) { s.noise.min = 9.0; }));
  EXPECT_TRUE(refused([](VirtualSensorSettings& s) { s.noise.dropout = 0.9; }));
  EXPECT_FALSE(VirtualSensor::create(std::vector<VirtualPerson>(7, {waving()}), {}).ok());
}

TEST(VirtualPerformer, OwnMotionsArePlayedUnchangedAndForeignOnesAreRetargeted) {
  const Character character = makeMannequin();
  const SkeletalMotion own = skeletalMotionOf(shippedFrames("wave")).value();
  VirtualPerformer carried = VirtualPerformer::create(character, own).value();
  carried.pose(3.0, Isometry3::Identity());
  const SkeletonFrame foreign = bodyJointsOf(own).value()[90];
  const Vec3 expected = (foreign[J::kRightHand].position - foreign[J::kRightElbow].position).normalized();
  const SkeletonFrame& joints = carried.joints();
  EXPECT_GT((joints[J::kRightHand].position - joints[J::kRightElbow].position).normalized().dot(expected), 0.99);

  SkeletalMotion same{"", character.skeleton, {0.0, 1.0}, {}};
  Pose pose = restPose(character.skeleton);
  same.poses.insert(same.poses.end(), pose.begin(), pose.end());
  pose[character.skeleton.jointOf(HumanBone::kLeftUpperArm)].rotation = Quat(Eigen::AngleAxisd(-1.0, Vec3::UnitZ()));
  same.poses.insert(same.poses.end(), pose.begin(), pose.end());
  VirtualPerformer played = VirtualPerformer::create(character, same).value();
  played.pose(0.5, Isometry3::Identity());
  const Vec3 arm = played.joints()[J::kLeftElbow].position - played.joints()[J::kLeftShoulder].position;
  EXPECT_NEAR(std::atan2(-arm.y(), arm.x()), 0.5, 0.02);
  EXPECT_FALSE(VirtualPerformer::create(character, std::vector<SkeletonFrame>{}).ok());
}

}  // namespace
}  // namespace lorica
