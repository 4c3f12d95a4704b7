#include "capture/standing_legs.h"

#include "capture/synthetic/synthetic_motion.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

using J = BodyJoint;

/// Somebody on a chair: only what is above the hips is known.
std::vector<SkeletonFrame> seated(SyntheticMotion motion) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(motion);
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
  for (SkeletonFrame& frame : seated(SyntheticMotion::kWave)) {
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
  for (SkeletonFrame& frame : seated(SyntheticMotion::kSquatAndReach)) {
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
  SkeletonFrame first = seated(SyntheticMotion::kWave).front();
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
  for (const SkeletonFrame& before : synthesizeMotion(SyntheticMotion::kWalk)) {
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
  const std::vector<SkeletonFrame> whole = synthesizeMotion(SyntheticMotion::kWave);
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
  for (const SkeletonFrame& before : seated(SyntheticMotion::kWalk)) {
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
