#include "capture/leg_judge.h"

#include "capture/files/joint_stream.h"
#include "capture/synthetic/synthetic_motion.h"
#include "tests/capture/spoiled_legs.h"
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
  for (int m = 0; m < kSyntheticMotionCount; ++m) {
    const auto motion = static_cast<SyntheticMotion>(m);
    EXPECT_EQ(refusedShare(synthesizeMotion(motion)), 0.0) << nameOf(motion);
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
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  for (SkeletonFrame& frame : frames) test::turnUpwards(frame);
  EXPECT_LT(refusedFrom(frames), 1.1);
}

TEST(LegJudge, ThighsThatChangeTheirLengthAreRefusedWithinTwoSeconds) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    test::scaleThighs(frames[f], 1.0 + 0.6 * std::sin(1.7 * static_cast<double>(f)));
  }
  EXPECT_LT(refusedFrom(frames), 2.0);
}

TEST(LegJudge, InferredJointsAreJudgedMoreStrictly) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
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
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  for (SkeletonFrame& frame : frames) test::turnUpwards(frame, std::span(test::kLegs).first(1));
  EXPECT_EQ(refusedShare(frames), 0.0);
}

TEST(LegJudge, AHandstandIsNotJudgedByItsFeet) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  for (SkeletonFrame& frame : frames) {
    for (TrackedJoint& joint : frame.joints) joint.position.y() = 2.0 - joint.position.y();
  }
  EXPECT_EQ(refusedShare(frames), 0.0);
}

TEST(LegJudge, RefusedLegsReturnWhenTheyArePlausibleAgain) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
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

}  // namespace
}  // namespace lorica
