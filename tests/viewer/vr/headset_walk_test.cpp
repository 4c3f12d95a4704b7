#include "capture/tracking/live_joints.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/registration/wandering_walk.h"
#include "tests/viewer/vr/headsets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <thread>
#include <vector>

namespace lorica::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRate = 10.0;                            // images of the camera in a second of the walk
constexpr double kSlowest = 0.1;                          // between poses of a headset, for a registration [s]
constexpr std::size_t kStands = 10, kStandsAtMost = 100;  // images, with a headset that is registered and without
constexpr double kNear = 0.04;                            // [m]
constexpr int kWalkPatience = 3000;                       // pictures
const Vec3 kHeadInHeadset(0.0, -0.11, 0.1);

/// Images of a virtual camera, each of which comes when it is released: so the walk goes at the speed of the pictures.
/// The last one is repeated. It waits as long as that takes: a camera that says that nothing came, says that nobody is
/// seen.
class ReleasedImages final : public DepthSource {
 public:
  explicit ReleasedImages(std::vector<DepthFrame> images) : images_(std::move(images)) {}
  [[nodiscard]] const DepthCamera& camera() const override { return camera_; }
  [[nodiscard]] std::string name() const override { return "a walk"; }
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) override {
    while (given_ >= released && !over) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (over) return DepthRead::kEnd;
    frame = images_[std::min(given_, images_.size() - 1)];
    frame.time = static_cast<double>(given_++) / kRate;
    return DepthRead::kFrame;
  }

  std::atomic<std::size_t> released = 0;
  std::atomic<bool> over = false;

 private:
  DepthCamera camera_;
  std::vector<DepthFrame> images_;
  std::size_t given_ = 0;
};

TEST_F(Headsets, AWalkBeforeADepthCameraRegistersTheHeadset) {
  // Somebody walks, and the camera sees them.
  std::vector<VirtualPerson> people;
  people.push_back({valueOf(VirtualPerformer::create(makeMannequin(), wanderingWalk(8.0, 1)))});
  people[0].worldFromMotion.translation().z() = 0.3;
  VirtualSensorSettings settings;
  settings.framesPerSecond = kRate;
  VirtualSensor sensor = valueOf(VirtualSensor::create(std::move(people), settings));
  std::vector<DepthFrame> images(sensor.frameCount());
  std::vector<SkeletonFrame> truth;
  for (std::size_t i = 0; i < images.size(); ++i) {
    sensor.render(i, images[i]);
    truth.push_back(moved(sensor.truth()[0].joints, sensor.floorFromCamera()));
  }
  // The headset counts from elsewhere.
  Registration known;
  known.yaw = 0.8;
  known.translation = {1.3, 0.0, -0.7};
  const auto wear = [&](std::size_t image) {
    const TrackedJoint& head = truth[std::min(image, truth.size() - 1)][BodyJoint::kHead];
    const Quat floorFromHeadset = *head.orientation * Quat(Eigen::AngleAxisd(kPi, Vec3::UnitY()));
    const Vec3 eyes = head.position - floorFromHeadset * kHeadInHeadset;
    const Isometry3 stageFromFloor = known.stageFromFloor();
    told.head = {stageFromFloor * eyes, Quat(Mat3(stageFromFloor.linear() * floorFromHeadset.toRotationMatrix()))};
  };

  auto walk = std::make_unique<ReleasedImages>(std::move(images));
  ReleasedImages& camera = *walk;
  auto sources = std::make_shared<LiveSources>();
  DepthJoints tracking(std::move(walk), valueOf(Tracker::create(camera.camera())));
  sources->headset = std::make_shared<WornHeadset>();
  tracking.wear(sources->headset);
  auto joints = std::make_unique<LiveJoints>(std::move(tracking));
  sources->tracked = joints.get();
  sources->name = joints->source().name();
  sources->joints.push_back(std::move(joints));
  const std::shared_ptr<ReleasedImages> atEnd(&camera, [](ReleasedImages* it) { it->over = true; });
  LiveRequest live;
  live.headset = true;
  run = valueOf(lorica::Run::start(valueOf(prepareLiveCast(request(), live, host, sources)), {}, host));
  WindowChoices choices = window->choices();
  choices.inside = true;
  choices.quality = 0;
  window->setChoices(choices);

  // They take a step when the headset was where they are, and the image of that was tracked. At last they stand.
  std::size_t step = 0;
  double begun = 0.0, last = 0.0;
  std::vector<double> intervals;
  wear(0);
  playUntil(
      [&] {
        if (window->headset() == nullptr || !frame().located) return false;
        if (begun == 0.0) begun = last = frame().time;
        intervals.push_back(frame().time - std::exchange(last, frame().time));
        if (!arrived()) return false;
        if (camera.released == step) {
          camera.released = step + 1;
          return false;
        }
        if (run->sight()->image.time < static_cast<double>(step) / kRate) return false;
        if (step >= truth.size() + (run->sight()->worn ? kStands : kStandsAtMost)) return true;
        wear(++step);
        return false;
      },
      kWalkPatience);
  std::sort(intervals.begin(), intervals.end());
  const double usual = intervals[intervals.size() / 2], slow = intervals[intervals.size() * 9 / 10];
  std::printf("%zu images in %.1f s, a pose each %.0f ms, one of ten later than %.0f ms\n", step + 1, last - begun,
              1e3 * usual, 1e3 * slow);
  // Late poses are gaps, and each leaves out the images of the next 0.2 s.
  if (!sources->headset->registration() && slow > kSlowest) {
    GTEST_SKIP() << "this machine is too slow: a registration needs ten pictures a second";
  }
  ASSERT_TRUE(sources->headset->registration());
  const Registration found = *sources->headset->registration();
  const Vec3 level = (found.stageFromFloor().inverse() * known.stageFromFloor()).translation();
  std::printf("yaw off by %.2f degrees, floor by %.0f mm, lag %.0f ms\n", (found.yaw - known.yaw) * 180.0 / kPi,
              1e3 * level.norm(), 1e3 * found.lag);
  EXPECT_NEAR(found.yaw, known.yaw, kPi / 180.0);
  EXPECT_LT(level.norm(), 0.05);

  // The avatar stands where they do, and their eyes are in its head. The camera sees them with the headset.
  const SessionAvatar& avatar = run->session.avatar();
  const DepthSight& sight = *run->sight();
  const auto jointAt = [&](HumanBone bone) -> Vec3 {
    return avatar.worldFromJoint()[avatar.character().skeleton.jointOf(bone)].translation();
  };
  const auto middleOf = [](const Vec3& a, const Vec3& b) { return Vec3(0.5 * (a + b)); };
  const SkeletonFrame& person = truth.back();
  const Vec3 worn = found.headInFloor(frame().stageFromHead.translation(), Quat(frame().stageFromHead.linear()));
  const Vec3 head = jointAt(HumanBone::kHead) + sight.stage;
  const Vec3 hips = middleOf(jointAt(HumanBone::kLeftUpperLeg), jointAt(HumanBone::kRightUpperLeg)) + sight.stage;
  const Vec3 inEyes = window->place().worldFromStage() * (frame().stageFromHead * found.headInHeadset);
  const double headOff = (head - person[BodyJoint::kHead].position).norm();
  const double hipsOff =
      (hips - middleOf(person[BodyJoint::kLeftHip].position, person[BodyJoint::kRightHip].position)).norm();
  std::printf("head from the headset by %.0f mm, from the true one by %.0f mm; hips from the true ones by %.0f mm\n",
              1e3 * (head - worn).norm(), 1e3 * headOff, 1e3 * hipsOff);
  EXPECT_LT((head - worn).norm(), kNear);
  EXPECT_LT(headOff, kNear);
  EXPECT_LT(hipsOff, kNear);
  EXPECT_LT((jointAt(HumanBone::kHead) - inEyes).norm(), 1e-3);
  if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
    EXPECT_TRUE(writePng(std::string(to) + "/walked.png", window->headset()->picture(0)));
  }
}

}  // namespace
}  // namespace lorica::test
