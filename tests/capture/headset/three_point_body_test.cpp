#include "capture/headset/three_point_body.h"

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/headset/worn_headset.h"
#include "capture/retarget/skeletal_retarget.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

namespace lorica {
namespace {

using J = BodyJoint;
constexpr double kPi = std::numbers::pi;

Isometry3 poseAt(const Vec3& at, const Mat3& turned) {
  Isometry3 pose = Isometry3::Identity();
  pose.linear() = turned;
  pose.translation() = at;
  return pose;
}
Mat3 axes(const Vec3& x, const Vec3& y, const Vec3& z) {
  Mat3 made;
  made << x, y, z;
  return made;
}
/// From the definition of grip poses: +X leaves a left palm and enters a right one, -Z goes from the little finger to
/// the thumb. Palms are down and thumbs ahead in a T-pose that faces +Z.
const std::array<Mat3, 2> kTposeGrips = {axes(-Vec3::UnitY(), -Vec3::UnitX(), -Vec3::UnitZ()),
                                         axes(Vec3::UnitY(), Vec3::UnitX(), -Vec3::UnitZ())};
const Mat3 kHeadset = Eigen::AngleAxisd(kPi, Vec3::UnitY()).toRotationMatrix();  // that looks along +Z

constexpr double kPalm = 0.08;  // from the wrist [m]

/// What a headset would tell of somebody whose joints are known, with orientations; their hands are wrists.
HeadAndHands wornBy(const SkeletonFrame& frame) {
  HeadAndHands told;
  told.time = frame.time;
  const Mat3 head = frame[J::kHead].orientation->toRotationMatrix() * kHeadset;
  told.head = poseAt(frame[J::kHead].position + head * Vec3(0.0, 0.1, -0.1), head);
  for (const std::size_t side : {0, 1}) {
    const TrackedJoint& hand = frame[side == 0 ? J::kLeftHand : J::kRightHand];
    const Mat3 turned = hand.orientation->toRotationMatrix();
    told.hands[side] = poseAt(hand.position + (side == 0 ? kPalm : -kPalm) * turned.col(0), turned * kTposeGrips[side]);
  }
  return told;
}

/// Somebody who stands at the origin, looks along +Z and holds their hands there.
HeadAndHands standing(double eyes, const Vec3& leftHand, const Vec3& rightHand) {
  HeadAndHands told;
  told.head = poseAt({0.0, eyes, 0.0}, kHeadset);
  told.hands = {poseAt(leftHand, kTposeGrips[0]), poseAt(rightHand, kTposeGrips[1])};
  return told;
}

TEST(ThreePointBody, StandsInATPose) {
  constexpr double kEyes = 1.638;  // a person of 1.75 m
  ThreePointBody body;
  const SkeletonFrame frame = body.follow(standing(kEyes, {0.85, 1.41, -0.1}, {-0.85, 1.41, -0.1}));
  EXPECT_TRUE(frame[J::kHead].position.isApprox(Vec3(0.0, kEyes - 0.1, -0.1), 1e-12));
  for (const J joint : {J::kHead, J::kTorso, J::kLeftHand, J::kRightHand}) {
    ASSERT_TRUE(frame[joint].orientation);
    EXPECT_LT(frame[joint].orientation->angularDistance(Quat::Identity()), 1e-7) << nameOf(joint);
  }
  EXPECT_NEAR(frame[J::kNeck].position.y(), 0.818 * 1.75, 0.02);  // Drillis and Contini
  EXPECT_NEAR(frame[J::kLeftHip].position.y(), 0.52 * 1.75, 0.03);
  for (const std::size_t side : {0, 1}) {
    const double out = side == 0 ? 1.0 : -1.0;
    const Vec3 shoulder = frame[side == 0 ? J::kLeftShoulder : J::kRightShoulder].position;
    const Vec3 elbow = frame[side == 0 ? J::kLeftElbow : J::kRightElbow].position;
    const Vec3 hand = frame[side == 0 ? J::kLeftHand : J::kRightHand].position;
    EXPECT_EQ(hand, Vec3(0.85 * out, 1.41, -0.1));
    EXPECT_NEAR(shoulder.x(), 0.105 * 1.75 * out, 0.09);
    const double angle = std::acos((elbow - shoulder).normalized().dot((hand - elbow).normalized()));
    EXPECT_LT(angle, 0.35);
    const Vec3 foot = frame[side == 0 ? J::kLeftFoot : J::kRightFoot].position;
    EXPECT_NEAR(foot.y(), 0.08, 0.01);
    EXPECT_GT(out * foot.x(), 0.05);
  }
}

/// How far joints are from the true ones in a motion of which only head and hands are told [m].
struct Away {
  double elbows, shoulders, hips, knees, feet;
};
Away awayIn(const std::vector<SkeletonFrame>& truth) {
  ThreePointBody body;
  const auto median = [&](const std::vector<SkeletonFrame>& found, std::initializer_list<J> joints) {
    std::vector<double> away;
    for (std::size_t f = 0; f < truth.size(); ++f) {
      for (const J joint : joints) away.push_back((found[f][joint].position - truth[f][joint].position).norm());
    }
    std::ranges::nth_element(away, away.begin() + std::ssize(away) / 2);
    return away[away.size() / 2];
  };
  std::vector<SkeletonFrame> found;
  for (const SkeletonFrame& frame : truth) found.push_back(body.follow(wornBy(frame)));
  return {median(found, {J::kLeftElbow, J::kRightElbow}), median(found, {J::kLeftShoulder, J::kRightShoulder}),
          median(found, {J::kLeftHip, J::kRightHip}), median(found, {J::kLeftKnee, J::kRightKnee}),
          median(found, {J::kLeftFoot, J::kRightFoot})};
}
void print(std::string_view name, const Away& away) {
  std::printf("%-16s median cm from the truth: elbows %.1f, shoulders %.1f, hips %.1f, knees %.1f, feet %.1f\n",
              std::string(name).c_str(), 1e2 * away.elbows, 1e2 * away.shoulders, 1e2 * away.hips, 1e2 * away.knees,
              1e2 * away.feet);
}

TEST(ThreePointBody, IsNearTheTrueOneInMotionsThatShip) {
  for (const std::string_view motion : {"walk", "wave", "jumping_jacks", "squat_and_reach", "punch_and_kick"}) {
    SCOPED_TRACE(motion);
    const Away away = awayIn(shippedFrames(motion));
    print(motion, away);
    EXPECT_LT(away.elbows, 0.13);
    EXPECT_LT(away.shoulders, 0.1);
    EXPECT_LT(away.hips, 0.15);
  }
}

TEST(ThreePointBody, IsNearTheTrueOneInCapturedMotions) {
  for (const char* name : {"animated_drawings/zombie.bvh", "animated_drawings/jumping_jacks.bvh", "makehuman/walk1.bvh",
                           "makehuman/zombieWalk1.bvh"}) {
    SCOPED_TRACE(name);
    LORICA_REQUIRE_DATASET(file, std::string("bvh/") + name);
    const Result<BvhFile> read = readBvh(file);
    ASSERT_TRUE(read) << read.error().message;
    const Result<std::vector<SkeletonFrame>> truth = bodyJointsOf(read->motion);
    ASSERT_TRUE(truth) << truth.error().message;
    const Away away = awayIn(*truth);
    print(name, away);
    EXPECT_LT(away.elbows, 0.15);
    EXPECT_LT(away.hips, 0.15);
  }
}

TEST(ThreePointBody, TurnsAndGoesWithTheStage) {
  const Isometry3 moved = Eigen::Translation3d(0.7, 0.0, -2.0) * Eigen::AngleAxisd(2.4, Vec3::UnitY());
  ThreePointBody here, there;
  for (const SkeletonFrame& frame : shippedFrames("punch_and_kick")) {
    HeadAndHands told = wornBy(frame);
    const SkeletonFrame one = here.follow(told);
    told.head = moved * told.head;
    for (std::optional<Isometry3>& hand : told.hands) hand = moved * *hand;
    const SkeletonFrame other = there.follow(told);
    for (std::size_t j = 0; j < one.joints.size(); ++j) {
      ASSERT_LT((moved * one.joints[j].position - other.joints[j].position).norm(), 1e-6) << frame.time << " " << j;
    }
  }
}

TEST(ThreePointBody, AHandThatIsLostHangsDownAndComesBackWithoutAJump) {
  ThreePointBody body;
  HeadAndHands told = standing(1.6, {0.3, 1.4, 0.4}, {-0.3, 1.4, 0.4});
  const Isometry3 hand = *told.hands[1];
  Vec3 last = body.follow(told)[J::kRightHand].position;
  EXPECT_EQ(last, hand.translation());
  double lowest = last.y();
  for (int i = 1; i < 180; ++i) {
    told.time = i / 60.0;
    told.hands[1] = i >= 30 && i < 120 ? std::nullopt : std::optional(hand);
    const SkeletonFrame frame = body.follow(told);
    const TrackedJoint& joint = frame[J::kRightHand];
    EXPECT_LT((joint.position - last).norm(), 0.07) << i;
    EXPECT_LE(joint.confidence, told.hands[1] ? 1.0 : 0.5);
    last = joint.position;
    lowest = std::min(lowest, last.y());
  }
  EXPECT_LT(lowest, 0.9);
  EXPECT_EQ(last, hand.translation());
}

TEST(ThreePointBody, KneelsAndBows) {
  // From standing, the head sinks by 35 cm: looking ahead the knees bend, looking down the trunk does.
  for (const double pitch : {0.0, 1.0}) {
    ThreePointBody body;
    (void)body.follow(standing(1.6, {0.3, 1.0, 0.2}, {-0.3, 1.0, 0.2}));
    SkeletonFrame frame;
    for (int i = 1; i <= 60; ++i) {
      HeadAndHands told = standing(1.6, {0.3, 0.8, 0.4}, {-0.3, 0.8, 0.4});
      told.time = i / 60.0;
      const Mat3 turned = kHeadset * Eigen::AngleAxisd(-pitch, Vec3::UnitX()).toRotationMatrix();
      const Vec3 head(0.0, 1.15, pitch > 0.0 ? 0.4 : -0.1);
      told.head = poseAt(head - turned * Vec3(0.0, -0.1, 0.1), turned);
      frame = body.follow(told);
    }
    const Vec3 hips = 0.5 * (frame[J::kLeftHip].position + frame[J::kRightHip].position);
    const Vec3 trunk = frame[J::kNeck].position - hips;
    const double lean = std::atan2(trunk.z(), trunk.y());
    const Vec3 thigh = frame[J::kLeftKnee].position - frame[J::kLeftHip].position;
    const double knee = std::atan2(thigh.z(), -thigh.y());
    if (pitch == 0.0) {
      EXPECT_LT(lean, 0.02);
      EXPECT_GT(knee, 0.5);
    } else {
      EXPECT_GT(lean, 0.8);
      EXPECT_GT(hips.y(), 0.75);
      EXPECT_LT(knee, 0.5);
    }
  }
}

TEST(ThreePointBody, IsTheSameEachTimeAndAllocatesNothing) {
  ThreePointBody one, two;
  for (const SkeletonFrame& frame : shippedFrames("squat_and_reach")) {
    const HeadAndHands told = wornBy(frame);
    const long allocations = test::allocationCount();
    const SkeletonFrame a = one.follow(told);
    EXPECT_EQ(test::allocationCount(), allocations);
    const SkeletonFrame b = two.follow(told);
    for (std::size_t j = 0; j < a.joints.size(); ++j) ASSERT_EQ(a.joints[j].position, b.joints[j].position);
  }
}

TEST(ThreePointBody, AnyPoseGivesFiniteJoints) {
  // A headset on its side, upside down, at the floor and high up; hands within the trunk, at the shoulders and far
  // away.
  ThreePointBody body;
  int frames = 0;
  for (const double y : {0.0, 0.3, 1.6, 5.0}) {
    for (int turn = 0; turn < 8; ++turn) {
      for (const Vec3& hand : {Vec3(0.0, 1.0, 0.0), Vec3(0.18, 1.4, 0.0), Vec3(-30.0, 2.0, 9.0), Vec3(0.0, 0.0, 0.0)}) {
        HeadAndHands told = standing(y, hand, hand);
        told.head.linear() = Eigen::AngleAxisd(0.25 * kPi * turn, Vec3(1.0, 0.3, 0.2).normalized()).toRotationMatrix();
        told.time = ++frames / 90.0;
        const SkeletonFrame frame = body.follow(told);
        for (const TrackedJoint& joint : frame.joints) {
          ASSERT_TRUE(joint.position.allFinite()) << y << " " << turn;
          ASSERT_GT(joint.confidence, 0.0);
        }
      }
    }
  }
}

TEST(ThreePointJoints, NobodyIsThereBeforeAHeadsetIs) {
  const auto headset = std::make_shared<WornHeadset>();
  const std::unique_ptr<SkeletonSource> joints = makeThreePointJoints(headset);
  const auto next = [&] {
    Result<std::optional<SkeletonFrame>> got = joints->next();
    EXPECT_TRUE(got && *got);
    return **got;
  };
  EXPECT_EQ(next().user, kNobody);
  HeadAndHands told = standing(1.6, {0.3, 1.0, 0.2}, {-0.3, 1.0, 0.2});
  told.time = 100.0;
  told.hands[0]->translation().x() = std::numeric_limits<double>::quiet_NaN();
  headset->add(told);
  const SkeletonFrame first = next();
  EXPECT_NE(first.user, kNobody);
  EXPECT_EQ(first.time, 100.0);
  EXPECT_EQ(first[J::kRightHand].position, told.hands[1]->translation());
  EXPECT_EQ(first[J::kLeftHand].confidence, 0.5);  // it was not seen
  const SkeletonFrame again = next();
  EXPECT_GT(again.time, first.time);
  EXPECT_EQ(again[J::kHead].position, first[J::kHead].position);
}

Registration someRegistration() {
  Registration known;
  known.yaw = 0.7;
  known.translation = {0.3, 0.01, -1.2};
  known.headInHeadset = {0.0, -0.08, 0.09};
  known.lag = 0.06;
  return known;
}

/// Of a walk along a line while the head turns.
Vec3 placeAt(double t) {
  return {0.5 * t, 1.6, 0.2 * t};
}
Quat turnAt(double t) {
  return Quat(Eigen::AngleAxisd(0.8 * t, Vec3::UnitY()) * Eigen::AngleAxisd(0.2, Vec3::UnitX()));
}

void wear(WornHeadset& headset, double until) {
  for (int i = 0; i <= 90.0 * until; ++i) headset.add(i / 90.0, placeAt(i / 90.0), turnAt(i / 90.0));
}

TEST(WornHeadset, SaysWhereTheHeadIsInAnImageAndNow) {
  const Registration known = someRegistration();
  WornHeadset headset;
  headset.setRegistration(known);
  wear(headset, 2.0);
  const std::optional<WornHead> seen = headset.inImage(1.97), latest = headset.latest(2.01);
  ASSERT_TRUE(seen && latest);
  const Isometry3 floorFromStage = known.stageFromFloor().inverse();
  const auto expected = [&](double t) { return Vec3(floorFromStage * (placeAt(t) + turnAt(t) * known.headInHeadset)); };
  EXPECT_LT((seen->position - expected(1.97 - known.lag)).norm(), 1e-3);
  EXPECT_LT((latest->position - expected(2.0)).norm(), 1e-9);
  // A head looks along its +Z, a headset along its -Z; nodding does not change where it is ahead.
  const Vec3 look = floorFromStage.linear() * (turnAt(2.0) * -Vec3::UnitZ());
  EXPECT_LT((latest->orientation * Vec3::UnitZ() - look).norm(), 1e-9);
  EXPECT_LT((latest->orientation * Vec3::UnitY() - floorFromStage.linear() * (turnAt(2.0) * Vec3::UnitY())).norm(),
            1e-9);
  EXPECT_LT((latest->ahead() - Vec3(look.x(), 0.0, look.z()).normalized()).norm(), 1e-9);
}

TEST(WornHeadset, IsWhereItWasLastInAnImageThatCameSince) {
  Registration known = someRegistration();
  known.lag = 0.01;
  WornHeadset headset;
  headset.setRegistration(known);
  headset.add(0.0, placeAt(0.0), turnAt(0.0));
  EXPECT_FALSE(headset.inImage(0.03)) << "one pose is no path";
  headset.add(0.05, placeAt(0.05), turnAt(0.05));
  for (const double image : {0.06, 0.08, 0.3}) {
    const std::optional<WornHead> seen = headset.inImage(image);
    ASSERT_TRUE(seen) << image;
    EXPECT_LT((seen->position - headset.latest(image)->position).norm(), 1e-9);
  }
}

TEST(WornHeadset, SaysNothingUnregisteredTakenOffOrRestarted) {
  WornHeadset headset;
  wear(headset, 1.0);
  EXPECT_FALSE(headset.latest(1.0));
  headset.setRegistration(someRegistration());
  EXPECT_TRUE(headset.latest(1.0));
  EXPECT_TRUE(headset.inImage(1.0));
  EXPECT_FALSE(headset.latest(1.0 + 1.1 * WornHeadset::kGone));
  EXPECT_FALSE(headset.inImage(1.0 + 1.1 * WornHeadset::kGone));
  EXPECT_FALSE(headset.inImage(0.01)) << "before its first pose";
  headset.restart();
  EXPECT_FALSE(headset.latest(1.0));
  EXPECT_FALSE(headset.inImage(1.0));
  wear(headset, 1.0);
  headset.setRegistration(std::nullopt);
  EXPECT_FALSE(headset.latest(1.0));
}

TEST(WornHeadset, NonsenseAndOldPosesAreIgnored) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  WornHeadset headset;
  headset.setRegistration(someRegistration());
  wear(headset, 1.0);
  const Vec3 before = headset.latest(1.0)->position;
  headset.add(nan, Vec3::Zero(), Quat::Identity());
  headset.add(1.1, Vec3(nan, 0.0, 0.0), Quat::Identity());
  headset.add(1.1, Vec3::Zero(), Quat(0.0, 0.0, 0.0, 0.0));
  headset.add(0.5, Vec3::Zero(), Quat::Identity());
  EXPECT_EQ(headset.latest(1.0)->position, before);
}

TEST(WornHeadset, LooksAheadWhereverItNods) {
  for (double nod = -1.4; nod < 1.5; nod += 0.2) {
    const WornHead head{Vec3::Zero(),
                        Quat(Eigen::AngleAxisd(0.3 * kPi, Vec3::UnitY()) * Eigen::AngleAxisd(nod, Vec3::UnitX()))};
    EXPECT_LT((head.ahead() - Vec3(std::sin(0.3 * kPi), 0.0, std::cos(0.3 * kPi))).norm(), 1e-12) << nod;
  }
}

}  // namespace
}  // namespace lorica
