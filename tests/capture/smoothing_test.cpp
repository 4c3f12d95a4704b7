#include "capture/smoothing.h"

#include "capture/confidence_hold.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

namespace lorica {
namespace {

using test::degrees;

using J = BodyJoint;
constexpr double kPi = std::numbers::pi;

/// All joints at one position.
SkeletonFrame frameAt(double time, const Vec3& position) {
  SkeletonFrame frame;
  frame.time = time;
  for (TrackedJoint& joint : frame.joints) joint = {position, std::nullopt, 1.0};
  return frame;
}

TEST(OneEuro, WhatStandsStillStaysAndTheFirstFrameIsShownAsItIs) {
  OneEuroFilter filter;
  for (int f = 0; f < 90; ++f) {
    SkeletonFrame frame = frameAt(f / 30.0, Vec3(0.1, 1.2, -0.3));
    frame[J::kHead].orientation = Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()));
    filter.apply(frame);
    EXPECT_LT((frame[J::kHead].position - Vec3(0.1, 1.2, -0.3)).norm(), 1e-15);
    EXPECT_LT(frame[J::kHead].orientation->angularDistance(Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()))), 1e-7);
  }
  EXPECT_EQ(filter.delay(), 0.0);
}

TEST(OneEuro, ARampLagsByTheInverseOfTheCutoffWhateverTheSteps) {
  std::mt19937 random(3);
  for (const double speed : {0.2, 1.0, 3.0}) {
    for (const double beta : {0.0, 0.5, 2.0}) {
      const OneEuroSettings settings{.minCutoff = 1.0, .beta = beta};
      OneEuroFilter filter(settings);
      double time = 0.0;
      SkeletonFrame frame;
      for (int f = 0; f < 3000; ++f) {
        time += 0.01 + 0.03 * static_cast<double>(random() % 1000) / 1000.0;
        frame = frameAt(time, Vec3(0.6, 0.8, 0.0) * speed * time);
        filter.apply(frame);
      }
      const double expected = 1.0 / (2.0 * kPi * (settings.minCutoff + beta * speed));
      const double behind = (Vec3(0.6, 0.8, 0.0) * speed * time - frame[J::kNeck].position).norm();
      EXPECT_NEAR(behind, speed * expected, 1e-6 * speed);
      // The first second has a larger lag, because the speed is not known yet.
      EXPECT_NEAR(filter.delay(), expected, 0.003) << speed << " " << beta;
    }
  }
}

TEST(OneEuro, ASineLagsByThePhaseOfTheFilter) {
  for (const double rate : {30.0, 60.0, 200.0}) {
    for (const double frequency : {0.5, 1.0, 2.0}) {
      const OneEuroSettings settings{.minCutoff = 1.5, .beta = 0.0};
      OneEuroFilter filter(settings);
      const double omega = 2.0 * kPi * frequency;
      for (int f = 0; f < static_cast<int>(60.0 * rate); ++f) {
        SkeletonFrame frame = frameAt(f / rate, Vec3(0.3 * std::sin(omega * f / rate), 0, 0));
        filter.apply(frame);
      }
      // share / (1 - (1 - share) / z) at z = exp(i omega / rate).
      const double share = 1.0 / (1.0 + rate / (2.0 * kPi * settings.minCutoff));
      const std::complex<double> response = share / (1.0 - (1.0 - share) * std::polar(1.0, -omega / rate));
      // Straight lines at 30 frames per second are not a sine: hence the tolerance in milliseconds.
      EXPECT_NEAR(filter.delay(), -std::arg(response) / omega, rate < 50.0 ? 0.004 : 0.0015)
          << rate << " " << frequency;
    }
  }
}

TEST(OneEuro, OrientationsLagAsAngles) {
  OneEuroFilter filter({.minCutoff = 1.0, .beta = 0.0});
  SkeletonFrame frame;
  const double turn = 1.5;  // rad/s, more than a full turn in total
  for (int f = 0; f <= 300; ++f) {
    frame = frameAt(f / 30.0, Vec3::Zero());
    frame[J::kHead].orientation = Quat(Eigen::AngleAxisd(turn * f / 30.0, Vec3(1, 2, 2) / 3.0));
    if (f % 2 == 1) frame[J::kHead].orientation->coeffs() *= -1.0;  // the same rotation
    filter.apply(frame);
  }
  const Quat measured(Eigen::AngleAxisd(turn * 10.0, Vec3(1, 2, 2) / 3.0));
  EXPECT_NEAR(measured.angularDistance(*frame[J::kHead].orientation), turn / (2.0 * kPi), 1e-6);
  EXPECT_NEAR(frame[J::kHead].orientation->norm(), 1.0, 1e-12);
  EXPECT_FALSE(frame[J::kNeck].orientation);
}

TEST(OneEuro, ALostJointIsPassedOnAndStartsAgain) {
  OneEuroFilter filter;
  for (int f = 0; f < 60; ++f) {
    SkeletonFrame frame = frameAt(f / 30.0, Vec3(f / 30.0, 1, 0));
    if (f >= 20 && f < 30) frame[J::kLeftHand] = {Vec3(9, 9, 9), std::nullopt, 0.0};
    filter.apply(frame);
    if (f >= 20 && f < 30) {
      EXPECT_EQ(frame[J::kLeftHand].confidence, 0.0);
      EXPECT_EQ(frame[J::kLeftHand].position, Vec3(9, 9, 9));
    }
    if (f == 30) {
      EXPECT_EQ(frame[J::kLeftHand].position, Vec3(1, 1, 0));
    }
    EXPECT_LT(frame[J::kRightHand].position.x(), f / 30.0 + 1e-12);
  }
}

TEST(OneEuro, TimesThatStandStillOrGoBackShowWhatWasShown) {
  OneEuroFilter filter;
  SkeletonFrame frame = frameAt(1.0, Vec3::Zero());
  filter.apply(frame);
  frame = frameAt(1.1, Vec3::UnitX());
  filter.apply(frame);
  const Vec3 shown = frame[J::kHead].position;
  for (const double time : {1.1, 0.5, std::numeric_limits<double>::quiet_NaN()}) {
    frame = frameAt(time, Vec3(5, 5, 5));
    filter.apply(frame);
    EXPECT_EQ(frame[J::kHead].position, shown) << time;
  }
  frame = frameAt(100.0, Vec3(5, 5, 5));  // after a long pause the filter takes the new position
  filter.apply(frame);
  EXPECT_LT((frame[J::kHead].position - Vec3(5, 5, 5)).norm(), 0.01);
  frame = frameAt(100.1, Vec3(5, std::numeric_limits<double>::infinity(), 5));
  filter.apply(frame);
  frame = frameAt(100.2, Vec3(5, 5, 5));
  filter.apply(frame);
  EXPECT_EQ(frame[J::kHead].position, Vec3(5, 5, 5));
}

TEST(OneEuro, AllocatesNothingPerFrame) {
  const auto frames = test::valueOf(readJointCsv(test::recordingsFolder() / "walk_noisy.csv"));
  std::vector<SkeletonFrame> shown = frames;
  OneEuroFilter filter;
  const test::AllocationWatch watch;
  for (SkeletonFrame& frame : shown) {
    filter.apply(frame);
    mirror(frame);
  }
  EXPECT_GE(filter.delay(), 0.0);
  EXPECT_EQ(watch.largest(), 0u);
}

/// Second difference of a joint's error: visible shaking [m].
double shaking(const std::vector<SkeletonFrame>& frames, const std::vector<SkeletonFrame>& clean,
               const std::vector<SkeletonFrame>& noisy) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t f = 32; f < frames.size(); ++f) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const auto error = [&](std::size_t g) -> Vec3 {
        return frames[g].joints[j].position - clean[g].joints[j].position;
      };
      bool seen = true;
      for (std::size_t g = f - 2; g <= f; ++g) seen = seen && noisy[g].joints[j].confidence == 1.0;
      if (!seen) continue;
      sum += (error(f) - 2.0 * error(f - 1) + error(f - 2)).squaredNorm();
      count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

TEST(OneEuro, TheDefaultsCalmTheNoisyRecordingsWithinAFrame) {
  struct Row {  // of docs/JOINT_STREAMS.md [mm, mm, ms]
    const char* name;
    double before, after, delay;
  };
  for (const Row& row : {Row{"walk", 11.6, 6.2, 19}, Row{"punch_and_kick", 8.4, 4.9, 29}}) {
    SCOPED_TRACE(row.name);
    const auto clean = readJointCsv(test::recordingsFolder() / (std::string(row.name) + ".csv"));
    const auto noisy = readJointCsv(test::recordingsFolder() / (std::string(row.name) + "_noisy.csv"));
    ASSERT_TRUE(clean && noisy);
    std::vector<SkeletonFrame> smoothed = *noisy;
    OneEuroFilter filter;
    for (SkeletonFrame& frame : smoothed) filter.apply(frame);
    EXPECT_NEAR(1e3 * shaking(*noisy, *clean, *noisy), row.before, 0.051);
    EXPECT_NEAR(1e3 * shaking(smoothed, *clean, *noisy), row.after, 0.051);
    EXPECT_NEAR(1e3 * filter.delay(), row.delay, 0.51);
  }
}

TEST(OneEuro, ALostJointStillHoldsAndComesBackWithoutAJump) {
  const auto frames = test::valueOf(readJointCsv(test::recordingsFolder() / "walk_noisy.csv"));
  const Character mannequin = makeMannequin();
  for (const bool smooth : {false, true}) {
    OneEuroFilter filter;
    Retargeter retargeter = *Retargeter::create(mannequin.skeleton);
    Pose pose(static_cast<std::size_t>(mannequin.skeleton.jointCount())), before;
    const auto forearm = static_cast<std::size_t>(mannequin.skeleton.jointOf(HumanBone::kLeftLowerArm));
    Quat held = Quat::Identity();
    double largest = 0.0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      SkeletonFrame frame = frames[f];
      if (f >= 100 && f < 200) frame[J::kLeftHand] = {Vec3(3, 3, 3), std::nullopt, 0.0};
      if (smooth) filter.apply(frame);
      retargeter.apply(frame, pose);
      if (f == 99) held = pose[forearm].rotation;
      if (f == 110) {
        EXPECT_LT(pose[forearm].rotation.angularDistance(held), 1e-6) << "held";
      }
      if (f == 180) {
        const Quat& rest = mannequin.skeleton.joint(static_cast<JointIndex>(forearm)).rest.rotation;
        EXPECT_LT(pose[forearm].rotation.angularDistance(rest), 0.02) << "eased to rest";
      }
      if (f >= 195 && f < 215) {
        largest = std::max(largest, before[forearm].rotation.angularDistance(pose[forearm].rotation));
      }
      before = pose;
    }
    EXPECT_LE(largest, 2.0 * ConfidenceHoldSettings{}.returnTurn / 30.0);
  }
}

TEST(Mirror, SwapsSidesAndTwiceIsOnce) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const SkeletonFrame frame = test::makeFrame(test::randomPose(seed), 0.5, true);
    SkeletonFrame mirrored = frame;
    mirror(mirrored);
    const Vec3 hand = frame[J::kLeftHand].position;
    EXPECT_EQ(mirrored[J::kRightHand].position, Vec3(-hand.x(), hand.y(), hand.z()));
    EXPECT_EQ(mirrored.time, frame.time);
    mirror(mirrored);
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      EXPECT_EQ(mirrored.joints[j].position, frame.joints[j].position);
      EXPECT_EQ(mirrored.joints[j].orientation->coeffs(), frame.joints[j].orientation->coeffs());
    }
  }
}

TEST(Mirror, OrientationsStillPointAlongTheirLimbs) {
  const auto along = [](const SkeletonFrame& f, J from, J to, const Vec3& axis) {
    return test::angleBetween(*f[from].orientation * axis, f[to].position - f[from].position);
  };
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SkeletonFrame frame = test::makeFrame(test::randomPose(seed), 0.5, true);
    mirror(frame);
    EXPECT_LT(along(frame, J::kLeftShoulder, J::kLeftElbow, Vec3::UnitX()), 1e-6);
    EXPECT_LT(along(frame, J::kRightShoulder, J::kRightElbow, -Vec3::UnitX()), 1e-6);
    EXPECT_LT(along(frame, J::kLeftElbow, J::kLeftHand, Vec3::UnitX()), 1e-6);
    EXPECT_LT(along(frame, J::kRightHip, J::kRightKnee, -Vec3::UnitY()), 1e-6);
    EXPECT_LT(along(frame, J::kLeftKnee, J::kLeftFoot, -Vec3::UnitY()), 1e-6);
  }
}

Quat aboutZ(double angle) {
  return Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
}

Skeleton oneJoint(const Quat& rest) {
  Joint joint;
  joint.name = "joint";
  joint.rest.rotation = rest;
  return *Skeleton::create({joint});
}

constexpr double kFrame = 1.0 / 30.0;

TEST(ConfidenceHold, AJointNeverKnownShowsRest) {
  ConfidenceHold hold(oneJoint(aboutZ(0.4)), {});
  for (int i = 0; i < 100; ++i) {
    hold.beginFrame(i * kFrame);
    EXPECT_LT(hold.rotation(0, false, Quat(0, 0, 0, 0)).angularDistance(aboutZ(0.4)), 1e-12);
    EXPECT_EQ(hold.rootPosition(false, Vec3::Zero(), Vec3(1, 2, 3)), Vec3(1, 2, 3));
  }
}

TEST(ConfidenceHold, AKnownJointIsShownAsItIsFromTheFirstFrame) {
  ConfidenceHold hold(oneJoint(Quat::Identity()), {});
  for (int i = 0; i < 50; ++i) {
    hold.beginFrame(i * kFrame);
    const Quat live = aboutZ(0.3 * i);
    EXPECT_EQ(hold.rotation(0, true, live).coeffs(), live.coeffs());
    EXPECT_EQ(hold.rootPosition(true, Vec3(i, 0, 0), Vec3::Zero()), Vec3(i, 0, 0));
  }
}

TEST(ConfidenceHold, HoldsThenEasesToRestThenReturns) {
  const ConfidenceHoldSettings settings;
  ConfidenceHold hold(oneJoint(Quat::Identity()), settings);
  const Quat raised = aboutZ(2.0);
  double time = 0.0;
  hold.beginFrame(time);
  Quat before = hold.rotation(0, true, raised);
  const double eased = 1.5 * 2.0 / settings.easeSeconds * kFrame;  // max slope of a smooth-step is 1.5
  for (int i = 1; i <= 60; ++i) {
    hold.beginFrame(time += kFrame);
    const Quat now = hold.rotation(0, false, raised);
    EXPECT_LE(now.angularDistance(before), eased + 1e-9);
    if (i * kFrame <= settings.holdSeconds) {
      EXPECT_LT(now.angularDistance(raised), 1e-7) << i;
    }
    if (i * kFrame >= settings.holdSeconds + settings.easeSeconds) {
      EXPECT_LT(now.angularDistance(Quat::Identity()), 1e-6) << i;
    }
    before = now;
  }
  for (int i = 0; i < 12; ++i) {
    hold.beginFrame(time += kFrame);
    const Quat now = hold.rotation(0, true, raised);
    EXPECT_LE(now.angularDistance(before), settings.returnTurn * kFrame + 1e-9) << i;
    before = now;
  }
  EXPECT_LT(before.angularDistance(raised), 1e-9);
}

TEST(ConfidenceHold, ALiveValueOnTheFarSideNeverFlipsTheBlend) {
  const ConfidenceHoldSettings settings;
  ConfidenceHold hold(oneJoint(Quat::Identity()), settings);
  hold.beginFrame(0.0);
  Quat before = hold.rotation(0, false, Quat::Identity());
  for (int i = 1; i < 60; ++i) {
    hold.beginFrame(i * kFrame);
    // Alternates between both sides of the point opposite to the start of the blend.
    const Quat now = hold.rotation(0, true, aboutZ(std::numbers::pi + (i % 2 == 0 ? 0.1 : -0.1)));
    EXPECT_LE(now.angularDistance(before), settings.returnTurn * kFrame + 1e-9) << i;
    before = now;
  }
}

TEST(ConfidenceHold, AJointLostForOneFrameHardlyLags) {
  ConfidenceHold hold(oneJoint(Quat::Identity()), {});
  double largestLag = 0.0;
  for (int i = 0; i < 90; ++i) {
    hold.beginFrame(i * kFrame);
    const Quat live = aboutZ(2.0 * i * kFrame);
    const bool known = i % 5 != 3;
    const Quat shown = hold.rotation(0, known, live);
    if (known) largestLag = std::max(largestLag, shown.angularDistance(live));
  }
  EXPECT_LT(largestLag, 2.0 * kFrame);
}

TEST(ConfidenceHold, TheRootHoldsItsLastPositionAndGlidesBack) {
  const ConfidenceHoldSettings settings;
  ConfidenceHold hold(oneJoint(Quat::Identity()), settings);
  hold.beginFrame(0.0);
  (void)hold.rootPosition(true, Vec3(1, 1, 2), Vec3::Zero());
  double time = 0.0;
  for (int i = 0; i < 300; ++i) {
    hold.beginFrame(time += kFrame);
    EXPECT_EQ(hold.rootPosition(false, Vec3::Zero(), Vec3::Zero()), Vec3(1, 1, 2));
  }
  Vec3 before(1, 1, 2);
  for (int i = 0; i < 40; ++i) {
    hold.beginFrame(time += kFrame);
    const Vec3 now = hold.rootPosition(true, Vec3(3, 1, 2), Vec3::Zero());
    EXPECT_LE((now - before).norm(), settings.returnSpeed * kFrame + 1e-9);
    before = now;
  }
  EXPECT_LT((before - Vec3(3, 1, 2)).norm(), 1e-9);
}

TEST(ConfidenceHold, StrangeTimesDoNoHarm) {
  ConfidenceHold hold(oneJoint(Quat::Identity()), {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Quat before = Quat::Identity();
  bool first = true;
  for (const double time : {0.0, 1e9, nan, -5.0, -5.0, 0.0, 0.01, std::numeric_limits<double>::infinity(), 1.0}) {
    hold.beginFrame(time);
    const Quat now = hold.rotation(0, !first, aboutZ(3.0));
    EXPECT_TRUE(now.coeffs().allFinite());
    EXPECT_LE(now.angularDistance(before), ConfidenceHoldSettings{}.returnTurn * 0.1 + 1e-9);
    before = now;
    first = false;
  }
}

}  // namespace
}  // namespace lorica
