#include "capture/confidence_hold.h"

#include "tests/capture/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace lorica {
namespace {

using test::degrees;

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
