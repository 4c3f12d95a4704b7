#include "capture/tracking/people_places.h"

#include "capture/synthetic/synthetic_motion.h"
#include "capture/tracking/depth_joints.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace lorica {
namespace {

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
    VirtualPerson made{VirtualPerformer::create(makeMannequin(), synthesizeMotion(SyntheticMotion::kWave)).value()};
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

}  // namespace
}  // namespace lorica
