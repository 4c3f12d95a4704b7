#include "capture/files/joint_csv.h"
#include "capture/tracking/depth_joints.h"

#include "capture/tracking/depth_joints.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// A given number of images of an empty room, one every 5 ms.
class Clockwork final : public DepthSource {
 public:
  Clockwork(int frames, bool breaks, std::shared_ptr<std::atomic<int>> reads)
      : frames_(frames), breaks_(breaks), reads_(std::move(reads)) {
    camera_.width = 320, camera_.height = 240;
  }
  const DepthCamera& camera() const override { return camera_; }
  std::string name() const override { return "clockwork"; }
  Result<DepthRead> next(DepthFrame& frame) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (reads_ != nullptr) ++*reads_;
    if (frame_ == frames_ && breaks_) return Error{ErrorCode::kUnreadable, "broken"};
    if (frame_ == frames_) return DepthRead::kEnd;
    frame.time = 0.005 * ++frame_;
    frame.depthMm.assign(320 * 240, 0);
    return DepthRead::kFrame;
  }

 private:
  DepthCamera camera_;
  int frames_, frame_ = 0;
  bool breaks_;
  std::shared_ptr<std::atomic<int>> reads_;  // may be null
};

DepthJoints following(int frames, bool breaks = false, std::shared_ptr<std::atomic<int>> reads = nullptr) {
  auto source = std::make_unique<Clockwork>(frames, breaks, std::move(reads));
  Tracker tracker = Tracker::create(source->camera()).value();
  return {std::move(source), std::move(tracker)};
}

TEST(LiveJoints, ASlowCallerGetsTheLatestAndEveryImageIsTracked) {
  const auto reads = std::make_shared<std::atomic<int>>(0);
  LiveJoints joints(following(60, false, reads));
  double last = 0.0;
  int asked = 0;
  while (true) {
    const int slow = std::min(*reads + 8, 61);  // images later; the last read is the end
    while (*reads < slow) std::this_thread::yield();
    const Result<std::optional<SkeletonFrame>> frame = joints.next();
    ASSERT_TRUE(frame.ok());
    if (!frame->has_value()) break;
    EXPECT_GT((*frame)->time, last);
    EXPECT_EQ((*frame)->time, joints.sight().image.time) << "joints and image are of the same frame";
    last = (*frame)->time;
    ++asked;
  }
  EXPECT_EQ(joints.frameCount(), 60);
  EXPECT_LT(asked, 60);
  EXPECT_FALSE(joints.next()->has_value()) << "the end is returned again";
}

TEST(LiveJoints, ErrorsReachTheCaller) {
  LiveJoints joints(following(3, true));
  Result<std::optional<SkeletonFrame>> frame = joints.next();
  while (frame.ok()) frame = joints.next();
  EXPECT_EQ(frame.error().message, "broken");
}

TEST(LiveJoints, MayBeLeftAtAnyTime) {
  for (const int images : {0, 1, 3}) {
    const auto reads = std::make_shared<std::atomic<int>>(0);
    {
      LiveJoints joints(following(1'000'000, false, reads));
      while (*reads < images) std::this_thread::yield();
    }
    // The thread has ended: no image is read after the destructor.
    const int before = reads->load();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(reads->load(), before);
    EXPECT_LT(before, 1'000'000);
  }
}

SkeletonFrame someone() {
  SkeletonFrame person = shippedFrames("wave").front();
  for (TrackedJoint& joint : person.joints) joint.confidence = 0.7;
  return person;
}

TEST(WornPerson, TheHeadGoesWithTheHeadsetAndTheFeetStay) {
  const SkeletonFrame before = someone();
  SkeletonFrame person = before;
  const WornHead then{before[BodyJoint::kHead].position + Vec3(0.02, 0.01, 0.0), Quat::Identity()};
  const WornHead latest{then.position + Vec3(0.1, -0.05, 0.04), Quat(Eigen::AngleAxisd(0.4, Vec3::UnitY()))};
  moveWithHead(then, latest, person);
  EXPECT_EQ(person[BodyJoint::kHead].position, latest.position);
  EXPECT_EQ(person[BodyJoint::kHead].orientation->coeffs(), latest.orientation.coeffs());
  EXPECT_EQ(person[BodyJoint::kHead].confidence, 1.0);
  for (const BodyJoint joint : {BodyJoint::kLeftFoot, BodyJoint::kLeftHip, BodyJoint::kNeck}) {
    const double share = before[joint].position.y() / then.position.y();
    const Vec3 expected = before[joint].position + share * Vec3(0.1, -0.05, 0.04);
    EXPECT_LT((person[joint].position - expected).norm(), 1e-12);
    EXPECT_EQ(person[joint].confidence, 0.7);
  }
  EXPECT_LT((person[BodyJoint::kLeftFoot].position - before[BodyJoint::kLeftFoot].position).norm(), 0.01);
}

TEST(WornPerson, AnothersHeadsetMovesNobody) {
  const SkeletonFrame before = someone();
  const WornHead beside{before[BodyJoint::kHead].position + Vec3(0.8, 0.0, 0.0), Quat::Identity()};
  SkeletonFrame person = before;
  moveWithHead(beside, {beside.position + Vec3(0.1, 0.0, 0.0), Quat::Identity()}, person);
  EXPECT_EQ(person[BodyJoint::kHead].position, before[BodyJoint::kHead].position);
  // Of a head that is not seen the torso tells.
  person[BodyJoint::kHead].confidence = 0.1;
  moveWithHead(beside, beside, person);
  EXPECT_EQ(person[BodyJoint::kHead].confidence, 0.1);
  const WornHead above{before[BodyJoint::kTorso].position + Vec3(0.3, 0.6, 0.0), Quat::Identity()};
  moveWithHead(above, above, person);
  EXPECT_EQ(person[BodyJoint::kHead].position, above.position);
  // An empty place has no torso either.
  SkeletonFrame nobody;
  moveWithHead(above, above, nobody);
  EXPECT_EQ(nobody[BodyJoint::kHead].confidence, 0.0);
}

TrackedPerson personAt(int user, double x) {
  TrackedPerson person;
  person.skeleton.user = user;
  for (TrackedJoint& joint : person.skeleton.joints) joint = {Vec3(x, 1.0, 0.0), {}, 1.0};
  return person;
}

/// Where the torso of each place is; NaN if its joints are unknown.
std::vector<double> torsos(const PeoplePlaces& places) {
  std::vector<double> all;
  for (const SkeletonFrame& frame : places.frames()) {
    const TrackedJoint& torso = frame[BodyJoint::kTorso];
    all.push_back(torso.confidence > 0.0 ? torso.position.x() : -100.0);
  }
  return all;
}

std::vector<bool> there(const PeoplePlaces& places) {
  std::vector<bool> all;
  for (const SkeletonFrame& frame : places.frames()) all.push_back(frame.user != kNobody);
  return all;
}

constexpr double kGone = -100.0;
using Torsos = std::vector<double>;
using There = std::vector<bool>;

TEST(PeoplePlaces, AreTakenInTheOrderOfComing) {
  PeoplePlaces places(2);
  EXPECT_EQ(places.frames().size(), 2u);
  places.update(std::vector{personAt(3, 1.0)}, 0.0);
  EXPECT_EQ(torsos(places), (Torsos{1.0, kGone}));
  EXPECT_EQ(there(places), (There{true, false}));
  places.update(std::vector{personAt(1, 5.0), personAt(3, 1.1)}, 0.1);  // a lower number came later
  EXPECT_EQ(torsos(places), (Torsos{1.1, 5.0}));
  places.update(std::vector{personAt(1, 5.0), personAt(2, 9.0), personAt(3, 1.2)}, 0.2);  // nobody's place
  EXPECT_EQ(torsos(places), (Torsos{1.2, 5.0}));
  EXPECT_EQ(places.frames()[1].user, 2);
  EXPECT_EQ(places.frames()[1].time, 0.2);
}

TEST(PeoplePlaces, WhoIsLostForAMomentStaysAndThenIsGone) {
  PeoplePlaces places(1);
  places.update(std::vector{personAt(1, 1.0)}, 0.0);
  places.update({}, 0.49);
  EXPECT_EQ(there(places), There{true});
  EXPECT_EQ(torsos(places), Torsos{kGone});
  places.update({}, 0.5);
  EXPECT_EQ(there(places), There{false});
}

TEST(PeoplePlaces, WhoComesBackWithinTwoSecondsHasTheSamePlace) {
  for (const auto& [seconds, place] : {std::pair{1.9, 1}, {2.1, 0}}) {
    PeoplePlaces places(2);
    places.update(std::vector{personAt(1, 0.0), personAt(2, 3.0)}, 0.0);
    places.update(std::vector{personAt(2, 3.0)}, 0.1);
    places.update({}, 0.2);
    // Number 1 is given again to whoever stands where number 2 stood.
    places.update(std::vector{personAt(1, 2.9)}, 0.1 + seconds);
    EXPECT_EQ(torsos(places)[static_cast<std::size_t>(place)], 2.9) << seconds;
  }
}

TEST(PeoplePlaces, TwoBeforeTheVirtualCameraKeepTheirs) {
  const auto person = [](double x) {
    VirtualPerson made{VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value()};
    made.worldFromMotion = Isometry3(Eigen::Translation3d(x, 0.0, 0.0));
    return made;
  };
  auto sensor = std::make_unique<VirtualSensor>(VirtualSensor::create({person(-0.7), person(0.7)}, {}).value());
  Tracker tracker = Tracker::create(sensor->camera()).value();
  DepthJoints joints(std::move(sensor), std::move(tracker), PeoplePlaces(2));
  int both = 0;
  double apart = 0.0;
  for (int frame = 0; frame < 40; ++frame) {
    const SkeletonFrame first = joints.next().value().value();
    const std::vector<SkeletonFrame>& places = joints.sight().places;
    ASSERT_EQ(places.size(), 2u);
    EXPECT_EQ(first.user, places[0].user);
    EXPECT_EQ(first.time, places[1].time);
    if (places[0].user == kNobody || places[1].user == kNobody) continue;
    ++both;
    apart = places[1][BodyJoint::kTorso].position.x() - places[0][BodyJoint::kTorso].position.x();
    EXPECT_NEAR(std::abs(apart), 1.4, 0.1);
  }
  EXPECT_GT(both, 25);
}

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
  VirtualPerson person{VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value()};
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
