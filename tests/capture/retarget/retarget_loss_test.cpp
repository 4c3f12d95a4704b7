#include "capture/retarget/retarget.h"

#include "tests/capture/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lorica {
namespace {

using test::angleBetween;
using test::degrees;
using test::Figure;
using test::makeFigure;
using test::makeFrame;
using test::PersonPose;
using test::worldOf;
using B = HumanBone;
using J = BodyJoint;

constexpr double kFrame = 1.0 / 30.0;

/// Both arms bent forward, both knees slightly bent; slowly swaying.
SkeletonFrame swayingFrame(double time, bool withOrientations) {
  PersonPose person;
  person.hips = Quat(Eigen::AngleAxisd(0.2 * std::sin(time), Vec3::UnitY()));
  person.chest = person.neck = person.head = person.hips;
  for (std::size_t i = 0; i < 2; ++i) {
    const double m = i == 0 ? 1.0 : -1.0;
    person.upper[i] = person.chest * Quat(Eigen::AngleAxisd(-m * degrees(40.0), Vec3::UnitZ())) *
                      Quat(Eigen::AngleAxisd(-m * (degrees(30.0) + 0.2 * std::sin(2.0 * time)), Vec3::UnitY()));
    person.lower[i] = person.upper[i] * Quat(Eigen::AngleAxisd(-m * degrees(80.0), Vec3::UnitY()));
    person.end[i] = person.lower[i];
  }
  for (std::size_t i = 2; i < 4; ++i) {
    person.upper[i] = person.hips * Quat(Eigen::AngleAxisd(-degrees(20.0), Vec3::UnitX()));
    person.lower[i] = person.hips * Quat(Eigen::AngleAxisd(degrees(20.0), Vec3::UnitX()));
    person.end[i] = person.hips;
  }
  person.middleHip = Vec3(0.5 + 0.1 * std::sin(time), 0.09 + 0.82 * std::cos(degrees(20.0)), 2.0);
  return makeFrame(person, time, withOrientations);
}

void lose(SkeletonFrame& frame, J joint) {
  frame[joint].position = Vec3::Zero();
  frame[joint].confidence = 0.0;
}

double largestTurn(const Pose& a, const Pose& b) {
  double largest = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    largest = std::max(largest, a[j].rotation.angularDistance(b[j].rotation));
  }
  return largest;
}

/// A figure and what moves it.
struct RetargetLoss : testing::Test {
  const Figure figure = makeFigure({});
  Retargeter retargeter = *Retargeter::create(figure.skeleton);
  Pose pose = Pose(figure.tposeRotation.size());
};

TEST_F(RetargetLoss, ALostJointHoldsEasesAndComesBackWithoutAJump) {
  for (const bool withOrientations : {false, true}) {
    for (int lost = 0; lost < kBodyJointCount; ++lost) {
      SCOPED_TRACE(nameOf(static_cast<J>(lost)));
      retargeter = *Retargeter::create(figure.skeleton);
      pose = Pose(pose.size());
      Retargeter reference = *Retargeter::create(figure.skeleton);
      Pose live(pose.size()), before;
      for (int f = 0; f < 150; ++f) {
        SkeletonFrame frame = swayingFrame(f * kFrame, withOrientations);
        reference.apply(frame, live);
        if (f >= 30 && f < 100) lose(frame, static_cast<J>(lost));
        retargeter.apply(frame, pose);
        if (!before.empty()) {
          // Factor 2: a forearm that already points right compensates for the remaining rotation of its upper arm.
          EXPECT_LE(largestTurn(pose, before), 2.0 * ConfidenceHoldSettings{}.returnTurn * kFrame) << f;
          EXPECT_LT((pose[0].translation - before[0].translation).norm(), 0.05 + 4.0 * kFrame) << f;
        }
        before = pose;
      }
      EXPECT_LT(largestTurn(pose, live), degrees(1.0)) << "the same as without the loss";
    }
  }
}

TEST_F(RetargetLoss, AnUnknownHandKeepsItsForearmThenRests) {
  const auto forearm = static_cast<std::size_t>(figure.skeleton.jointOf(B::kLeftLowerArm));
  Quat last = Quat::Identity();
  for (int f = 0; f < 120; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, false);
    if (f >= 30) lose(frame, J::kLeftHand);
    retargeter.apply(frame, pose);
    if (f < 30) last = pose[forearm].rotation;
    if (f >= 30 && f <= 44) {
      EXPECT_LT(pose[forearm].rotation.angularDistance(last), 1e-7) << f;
    }
  }
  EXPECT_GT(last.angularDistance(Quat::Identity()), degrees(60.0));
  EXPECT_LT(pose[forearm].rotation.angularDistance(Quat::Identity()), 1e-6);
}

TEST_F(RetargetLoss, UnknownJointsAtTheOriginPullNothing) {
  // Whatever position an unknown joint reports, the pose is bit-identical.
  std::mt19937 random(5);
  Retargeter a = *Retargeter::create(figure.skeleton);
  Retargeter b = *Retargeter::create(figure.skeleton);
  Pose poseA(figure.tposeRotation.size()), poseB(figure.tposeRotation.size());
  for (int f = 0; f < 200; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, f % 2 == 0);
    SkeletonFrame other = frame;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      if (random() % 3 != 0) continue;
      frame.joints[j] = {Vec3::Zero(), std::nullopt, 0.0};
      other.joints[j] = {Vec3(7, -8, 9), Quat(0, 1, 0, 0), 0.0};
    }
    a.apply(frame, poseA);
    b.apply(other, poseB);
    for (std::size_t j = 0; j < poseA.size(); ++j) {
      ASSERT_EQ(poseA[j].rotation.coeffs(), poseB[j].rotation.coeffs()) << f;
      ASSERT_EQ(poseA[j].translation, poseB[j].translation) << f;
    }
  }
}

TEST_F(RetargetLoss, NobodySeenShowsTheRestPose) {
  const Pose rest = restPose(figure.skeleton);
  for (int f = 0; f < 60; ++f) {
    SkeletonFrame frame;
    frame.time = f * kFrame;
    retargeter.apply(frame, pose);
    EXPECT_LT(largestTurn(pose, rest), 1e-9);
    EXPECT_LT((pose[0].translation - rest[0].translation).norm(), 1e-9);
  }
}

TEST_F(RetargetLoss, AnUpperBodyAloneMovesItsArms) {
  for (int f = 0; f < 30; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, false);
    for (const J joint : {J::kTorso, J::kLeftHip, J::kRightHip, J::kLeftKnee, J::kRightKnee, J::kLeftFoot,
                          J::kRightFoot, J::kHead, J::kNeck}) {
      lose(frame, joint);
    }
    retargeter.apply(frame, pose);
    const std::vector<Affine3> world = worldOf(figure.skeleton, pose);
    const auto at = [&](B bone) -> Vec3 { return world[figure.skeleton.jointOf(bone)].translation(); };
    const Vec3 upper = frame[J::kLeftElbow].position - frame[J::kLeftShoulder].position;
    EXPECT_LT(angleBetween(at(B::kLeftLowerArm) - at(B::kLeftUpperArm), upper), degrees(0.1));
    EXPECT_NEAR(at(B::kLeftFoot).y(), 0.08, 1e-6);
  }
}

TEST_F(RetargetLoss, LegsThatEaseToRestStayAboveTheFloor) {
  // A person sits down and the legs are hidden: the character's legs straighten and must raise it.
  for (int f = 0; f < 120; ++f) {
    PersonPose person;
    for (std::size_t i = 2; i < 4; ++i) person.upper[i] = Quat(Eigen::AngleAxisd(-degrees(85.0), Vec3::UnitX()));
    person.middleHip = Vec3(0, 0.53, 2);
    SkeletonFrame frame = makeFrame(person, f * kFrame, false);
    if (f >= 30) {
      for (const J joint : {J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) lose(frame, joint);
    }
    retargeter.apply(frame, pose);
    const std::vector<Affine3> world = worldOf(figure.skeleton, pose);
    const auto foot = static_cast<std::size_t>(figure.skeleton.jointOf(B::kLeftFoot));
    EXPECT_GT(world[foot].translation().y(), 0.08 - 0.011) << f;
  }
}

TEST_F(RetargetLoss, OrientationsThatComeAndGoDoNotJump) {
  Pose before;
  for (int f = 0; f < 200; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, true);
    // The forearms' own orientation is a rotation by 90 degrees; sometimes it is missing.
    for (const J joint : {J::kLeftElbow, J::kLeftHand}) {
      frame[joint].orientation = *frame[joint].orientation * Quat(Eigen::AngleAxisd(degrees(90.0), Vec3::UnitX()));
    }
    if (f / 20 % 2 == 1) {
      for (TrackedJoint& joint : frame.joints) joint.orientation.reset();
    }
    retargeter.apply(frame, pose);
    const auto forearm = static_cast<std::size_t>(figure.skeleton.jointOf(B::kLeftLowerArm));
    if (!before.empty()) {
      EXPECT_LT(pose[forearm].rotation.angularDistance(before[forearm].rotation), degrees(18.0));
    }
    before = pose;
  }
}

TEST_F(RetargetLoss, WildNumbersNeverGiveNan) {
  std::mt19937 random(11);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const std::array<double, 8> wild = {0.0, 1.0, -1.0, nan, inf, -inf, 1e6, 1e-12};
  const auto pick = [&] { return wild[random() % wild.size()]; };
  for (int f = 0; f < 3000; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, true);
    if (random() % 10 == 0) frame.time = pick();
    for (TrackedJoint& joint : frame.joints) {
      if (random() % 4 == 0) joint.position = Vec3(pick(), pick(), pick());
      if (random() % 4 == 0) joint.orientation = Quat(pick(), pick(), pick(), pick());
      if (random() % 4 == 0) joint.confidence = pick();
    }
    // All joints at one position, or along one line.
    if (random() % 7 == 0) {
      for (TrackedJoint& joint : frame.joints) joint.position = Vec3(0, 1, 0);
    }
    if (random() % 7 == 0) {
      for (std::size_t j = 0; j < kBodyJointCount; ++j) frame.joints[j].position = Vec3(0, 0.1 * double(j), 0);
    }
    retargeter.apply(frame, pose);
    for (const JointTransform& t : pose) {
      ASSERT_TRUE(t.rotation.coeffs().allFinite() && t.translation.allFinite()) << f;
      ASSERT_NEAR(t.rotation.norm(), 1.0, 1e-9) << f;
    }
  }
}

}  // namespace
}  // namespace lorica
