#include "capture/tracking/depth_joints.h"

#include "capture/synthetic/synthetic_motion.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// The scripted results of a source, in order. Frames are empty rooms.
struct Turn {
  DepthRead read;
  double time = 0.0;
};

class ScriptedSource final : public DepthSource {
 public:
  explicit ScriptedSource(std::vector<Turn> turns) : turns_(std::move(turns)) {
    camera_.width = 320, camera_.height = 240;
  }
  const DepthCamera& camera() const override { return camera_; }
  std::string name() const override { return "scripted"; }
  Result<DepthRead> next(DepthFrame& frame) override {
    const Turn turn = turns_[turn_++];
    if (turn.read == DepthRead::kFrame) {
      frame.time = turn.time;
      frame.depthMm.assign(320 * 240, 0);
    }
    return turn.read;
  }

 private:
  DepthCamera camera_;
  std::vector<Turn> turns_;
  std::size_t turn_ = 0;
};

DepthJoints scripted(std::vector<Turn> turns) {
  auto source = std::make_unique<ScriptedSource>(std::move(turns));
  Tracker tracker = Tracker::create(source->camera()).value();
  return {std::move(source), std::move(tracker)};
}

VirtualPerson waver(const Vec3& position) {
  VirtualPerson person{VirtualPerformer::create(makeMannequin(), synthesizeMotion(SyntheticMotion::kWave)).value()};
  person.worldFromMotion = Isometry3(Eigen::Translation3d(position));
  return person;
}

DepthJoints before(std::vector<VirtualPerson> people, VirtualSensorSettings settings, int whom = 0) {
  auto sensor = std::make_unique<VirtualSensor>(VirtualSensor::create(std::move(people), settings).value());
  Tracker tracker = Tracker::create(sensor->camera()).value();
  return {std::move(sensor), std::move(tracker), whom};
}

TEST(DepthJoints, TimesRiseThroughSilenceAndANewClock) {
  DepthJoints joints = scripted({{DepthRead::kFrame, 5.0},
                                 {DepthRead::kWaiting},
                                 {DepthRead::kUnplugged},
                                 {DepthRead::kFrame, 0.5},  // the sensor's clock restarted
                                 {DepthRead::kFrame, 0.6},
                                 {DepthRead::kEnd}});
  std::vector<double> times;
  while (true) {
    const Result<std::optional<SkeletonFrame>> frame = joints.next();
    ASSERT_TRUE(frame.ok());
    if (!frame->has_value()) break;
    for (const TrackedJoint& joint : (*frame)->joints) EXPECT_EQ(joint.confidence, 0.0);
    EXPECT_FALSE(joints.sight().followed);
    times.push_back((*frame)->time);
  }
  ASSERT_EQ(times.size(), 5u);
  EXPECT_EQ(times[0], 5.0);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GT(times[i], times[i - 1]) << i;
  EXPECT_NEAR(times[4] - times[3], 0.1, 1e-12) << "the time steps are those of the restarted clock";
}

TEST(DepthJoints, ThePersonStandsAtTheOriginWhereverTheCameraSeesThem) {
  DepthJoints joints = before({waver({0.5, 0.0, -0.4})}, {});
  Result<std::optional<SkeletonFrame>> frame = joints.next();
  for (int i = 0; i < 20 && frame.ok() && !joints.sight().followed; ++i) frame = joints.next();
  ASSERT_TRUE(frame.ok() && frame->has_value());
  ASSERT_TRUE(joints.sight().followed);
  const Vec3 torso = (**frame)[BodyJoint::kTorso].position;
  EXPECT_NEAR(torso.x(), 0.0, 1e-9);
  EXPECT_NEAR(torso.z(), 0.0, 1e-9);
  EXPECT_NEAR(torso.y(), 1.15, 0.15) << "height over the floor";
}

TEST(DepthJoints, TheNearestIsFollowedAndStaysTheOneWhileSeen) {
  VirtualSensorSettings settings;
  settings.noise = DepthNoiseSettings::clean();
  DepthJoints joints = before({waver({-0.6, 0.0, 0.3}), waver({0.6, 0.0, -0.5})}, settings);
  int user = 0;
  for (int i = 0; i < 20; ++i) {
    const Result<std::optional<SkeletonFrame>> frame = joints.next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    if (!joints.sight().followed) continue;
    if (user == 0) user = (*frame)->user;
    EXPECT_EQ((*frame)->user, user);
    // The other person stands 1.2 m to the right.
    EXPECT_NEAR((**frame)[BodyJoint::kTorso].position.x(), 0.0, 0.2);
  }
  EXPECT_GT(user, 0);
  EXPECT_EQ(joints.sight().people, 2);
}

TEST(DepthJoints, AMissingPersonLeavesTheJointsUnknown) {
  DepthJoints joints = before({waver({0.0, 0.0, 0.0})}, {}, 3);
  for (int i = 0; i < 10; ++i) {
    const Result<std::optional<SkeletonFrame>> frame = joints.next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    EXPECT_FALSE(joints.sight().followed);
    for (const TrackedJoint& joint : (*frame)->joints) EXPECT_EQ(joint.confidence, 0.0);
  }
}

}  // namespace
}  // namespace lorica
