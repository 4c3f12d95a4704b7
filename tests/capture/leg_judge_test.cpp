
#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "capture/standing_legs.h"
#include "tests/capture/spoiled_legs.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

using J = BodyJoint;

/// Share of the frames in which a leg was refused.
double refusedShare(std::vector<SkeletonFrame> frames) {
  LegJudge judge;
  int refused = 0;
  for (SkeletonFrame& frame : frames) {
    judge.apply(frame);
    refused += judge.plausible(0) && judge.plausible(1) ? 0 : 1;
  }
  return static_cast<double>(refused) / static_cast<double>(frames.size());
}

/// The time from which on a leg is refused in every frame [s]; the end if there is none.
double refusedFrom(std::vector<SkeletonFrame> frames) {
  LegJudge judge;
  double from = frames.back().time;
  bool before = false;
  for (SkeletonFrame& frame : frames) {
    judge.apply(frame);
    const bool refused = !judge.plausible(0) && !judge.plausible(1);
    if (refused && !before) from = frame.time;
    before = refused;
  }
  return before ? from - frames.front().time : frames.back().time - frames.front().time;
}

TEST(LegJudge, LegsOfEveryRecordingPass) {
  for (const std::string_view motion : kShippedMotions) {
    EXPECT_EQ(refusedShare(shippedFrames(motion)), 0.0) << motion;
  }
}

TEST(LegJudge, LegsOfRealPeoplePass) {
  for (const char* name : {"m01", "m02", "m04", "m07", "m10"}) {
    LORICA_REQUIRE_DATASET(file, std::string("joints/ui_prmd/") + name + "_s01_e01_positions.txt");
    const Result<JointStream> stream = readJointStream(file);
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_EQ(refusedShare(stream->frames), 0.0) << name;
  }
}

TEST(LegJudge, LegsThatRunUpwardsAreRefusedWithinASecond) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (SkeletonFrame& frame : frames) test::turnUpwards(frame);
  EXPECT_LT(refusedFrom(frames), 1.1);
}

TEST(LegJudge, ThighsThatChangeTheirLengthAreRefusedWithinTwoSeconds) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (std::size_t f = 0; f < frames.size(); ++f) {
    test::scaleThighs(frames[f], 1.0 + 0.6 * std::sin(1.7 * static_cast<double>(f)));
  }
  EXPECT_LT(refusedFrom(frames), 2.0);
}

TEST(LegJudge, InferredJointsAreJudgedMoreStrictly) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (std::size_t f = 0; f < frames.size(); ++f) {
    test::scaleThighs(frames[f], f % 2 == 0 ? 1.2 : 0.8);  // 20 % from the mean
  }
  EXPECT_EQ(refusedShare(frames), 0.0);
  for (SkeletonFrame& frame : frames) {
    for (const J joint : {J::kLeftKnee, J::kRightKnee}) frame[joint].confidence = 0.5;
  }
  EXPECT_LT(refusedFrom(frames), 2.0);
}

TEST(LegJudge, OneLegMayBeLiftedHigh) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (SkeletonFrame& frame : frames) test::turnUpwards(frame, std::span(test::kLegs).first(1));
  EXPECT_EQ(refusedShare(frames), 0.0);
}

TEST(LegJudge, AHandstandIsNotJudgedByItsFeet) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (SkeletonFrame& frame : frames) {
    for (TrackedJoint& joint : frame.joints) joint.position.y() = 2.0 - joint.position.y();
  }
  EXPECT_EQ(refusedShare(frames), 0.0);
}

TEST(LegJudge, RefusedLegsReturnWhenTheyArePlausibleAgain) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  const double end = frames.back().time;
  LegJudge judge;
  bool refused = false;
  for (const SkeletonFrame& clean : frames) {
    SkeletonFrame frame = clean;
    if (frame.time < 0.5 * end) {
      for (const J joint : {J::kLeftKnee, J::kRightKnee}) frame[joint].position.y() += 1.5;
    }
    judge.apply(frame);
    refused = refused || !judge.plausible(0);
    // A refused leg is unknown, and only then.
    EXPECT_EQ(frame[J::kLeftKnee].confidence == 0.0, !judge.plausible(0));
    EXPECT_EQ(frame[J::kLeftHip].confidence, clean[J::kLeftHip].confidence);
  }
  EXPECT_TRUE(refused);
  EXPECT_TRUE(judge.everImplausible());
  EXPECT_TRUE(judge.plausible(0)) << "after " << 0.5 * end << " s of plausible legs";
}

/// Somebody on a chair: only what is above the hips is known.
std::vector<SkeletonFrame> seated(std::string_view motion) {
  std::vector<SkeletonFrame> frames = shippedFrames(motion);
  for (SkeletonFrame& frame : frames) {
    for (const J joint : {J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) frame[joint] = {};
    for (TrackedJoint& joint : frame.joints) {
      if (joint.confidence > 0.0) joint.position.y() -= 0.45;
    }
  }
  return frames;
}

Vec3 middleHip(const SkeletonFrame& frame) {
  return 0.5 * (frame[J::kLeftHip].position + frame[J::kRightHip].position);
}

TEST(StandingLegs, StandOnTheFloorBelowTheHips) {
  StandingLegs legs(StandingLegs::Use::kAlways);
  for (SkeletonFrame& frame : seated("wave")) {
    legs.apply(frame);
    const Vec3 hips = middleHip(frame);
    EXPECT_GT(hips.y(), 0.7);
    EXPECT_LT(hips.y(), 1.1);
    for (const J foot : {J::kLeftFoot, J::kRightFoot}) {
      EXPECT_GT(frame[foot].confidence, 0.0);
      EXPECT_GT(frame[foot].position.y(), 0.0);
      EXPECT_LT(frame[foot].position.y(), 0.2);
      const Vec3 away = frame[foot].position - hips;
      EXPECT_LT(std::hypot(away.x(), away.z()), 0.45);
    }
    EXPECT_GT((frame[J::kLeftFoot].position - frame[J::kRightFoot].position).norm(), 0.05);
  }
}

TEST(StandingLegs, KeepTheirLengthsAndBendForward) {
  StandingLegs legs(StandingLegs::Use::kAlways);
  double thigh = 0.0, shin = 0.0;
  for (SkeletonFrame& frame : seated("squat_and_reach")) {
    legs.apply(frame);
    const Vec3 hip = frame[J::kLeftHip].position, knee = frame[J::kLeftKnee].position;
    const Vec3 foot = frame[J::kLeftFoot].position;
    if (thigh == 0.0) thigh = (knee - hip).norm();
    if (shin == 0.0) shin = (foot - knee).norm();
    EXPECT_NEAR((foot - knee).norm(), shin, 0.15 * shin);
    const Vec3 left = frame[J::kLeftHip].position - frame[J::kRightHip].position;
    const Vec3 forward = left.cross(Vec3::UnitY());
    EXPECT_GT((knee - 0.5 * (hip + foot)).dot(forward), -1e-2 * forward.norm());
  }
}

TEST(StandingLegs, StayInPlaceUntilTheHipsGoAway) {
  StandingLegs legs(StandingLegs::Use::kAlways);
  SkeletonFrame first = seated("wave").front();
  const auto at = [&](double time, const Vec3& moved) {
    SkeletonFrame frame = first;
    frame.time = time;
    for (TrackedJoint& joint : frame.joints) joint.position += joint.confidence > 0.0 ? moved : Vec3(Vec3::Zero());
    legs.apply(frame);
    return frame;
  };
  const SkeletonFrame begin = at(0.0, Vec3::Zero());
  const SkeletonFrame leaning = at(0.033, Vec3(0.08, 0.0, 0.0));
  EXPECT_LT((leaning[J::kLeftFoot].position - begin[J::kLeftFoot].position).norm(), 0.03);
  // Gone half a metre: after both steps the feet are below the hips again.
  SkeletonFrame gone = begin;
  for (int f = 2; f < 60; ++f) gone = at(0.033 * f, Vec3(0.5, 0.0, 0.0));
  for (const J foot : {J::kLeftFoot, J::kRightFoot}) {
    EXPECT_NEAR(gone[foot].position.x() - begin[foot].position.x(), 0.5, 0.05);
  }
}

TEST(StandingLegs, LeaveKnownLegsAlone) {
  StandingLegs legs(StandingLegs::Use::kIfUnknown);
  for (const SkeletonFrame& before : shippedFrames("walk")) {
    SkeletonFrame frame = before;
    legs.apply(frame);
    for (std::size_t j = 0; j < frame.joints.size(); ++j) {
      EXPECT_EQ(frame.joints[j].position, before.joints[j].position);
      EXPECT_EQ(frame.joints[j].confidence, before.joints[j].confidence);
    }
  }
}

TEST(StandingLegs, AppearAndGoWithoutAJump) {
  StandingLegs legs(StandingLegs::Use::kIfUnknown);
  const std::vector<SkeletonFrame> whole = shippedFrames("wave");
  Vec3 last = Vec3::Zero();
  bool stood = false;
  for (std::size_t f = 0; f < whole.size(); ++f) {
    const bool lost = whole[f].time > 1.0 && whole[f].time < 3.0;
    SkeletonFrame frame = whole[f];
    if (lost) {
      for (const J joint : {J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) frame[joint] = {};
    }
    legs.apply(frame);
    stood = stood || (lost && frame[J::kLeftFoot].confidence > 0.0);
    if (f > 0) {
      EXPECT_LT((middleHip(frame) - last).norm(), 0.05) << whole[f].time;
    }
    last = middleHip(frame);
  }
  EXPECT_TRUE(stood);
}

TEST(StandingLegs, AreTheSameEachTimeAndAllocateNothing) {
  StandingLegs one(StandingLegs::Use::kAlways), two(StandingLegs::Use::kAlways);
  for (const SkeletonFrame& before : seated("walk")) {
    SkeletonFrame a = before, b = before;
    const long allocations = test::allocationCount();
    one.apply(a);
    EXPECT_EQ(test::allocationCount(), allocations);
    two.apply(b);
    for (std::size_t j = 0; j < a.joints.size(); ++j) EXPECT_EQ(a.joints[j].position, b.joints[j].position);
  }
}

}  // namespace
}  // namespace lorica
