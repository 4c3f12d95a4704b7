#include "capture/headset/worn_headset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace lorica {
namespace {

constexpr double kPi = std::numbers::pi;

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
