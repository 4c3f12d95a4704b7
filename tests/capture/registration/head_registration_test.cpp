#include "capture/registration/head_registration.h"

#include "geometry/errors.h"
#include "geometry/random_numbers.h"
#include "tests/capture/registration/virtual_walk.h"
#include "tests/support/allocations.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::VirtualWalk;
using test::WalkSettings;
using Shape = test::WalkSettings::Shape;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Result<Registration> solved(const VirtualWalk& walk) {
  HeadRegistration registration;
  walk.walk(registration);
  return registration.solve();
}

/// All numbers of a registration as bits.
std::vector<std::uint64_t> bitsOf(const Registration& r) {
  std::vector<std::uint64_t> bits;
  for (const double value :
       {r.yaw, r.translation.x(), r.translation.y(), r.translation.z(), r.headInHeadset.x(), r.headInHeadset.y(),
        r.headInHeadset.z(), r.lag, r.residual, r.yawDeviation, r.levelDeviation, r.heightDeviation}) {
    bits.push_back(std::bit_cast<std::uint64_t>(value));
  }
  return bits;
}

/// Of many walks of one kind: errors against the truth, and these against what was said of them.
struct Trials {
  static constexpr int kCount = 100;

  int refused = 0;
  std::vector<double> yaw, level, height, head, lag, yawSaid, levelSaid, yawRatio, levelRatio, heightRatio;

  explicit Trials(const WalkSettings& settings) {
    for (int seed = 1; seed <= kCount; ++seed) {
      const VirtualWalk walk(settings, seed);
      const Result<Registration> found = solved(walk);
      if (!found) {
        ++refused;
        continue;
      }
      const test::RegistrationErrors errors = errorsOf(*found, walk);
      yaw.push_back(errors.yaw / kDegree);
      level.push_back(1e3 * errors.level);
      height.push_back(1e3 * errors.height);
      head.push_back(1e3 * errors.head);
      lag.push_back(1e3 * errors.lag);
      yawSaid.push_back(found->yawDeviation / kDegree);
      levelSaid.push_back(1e3 * found->levelDeviation);
      yawRatio.push_back(errors.yaw / found->yawDeviation);
      levelRatio.push_back(errors.level / found->levelDeviation);
      heightRatio.push_back(errors.height / found->heightDeviation);
    }
  }
  /// @param share  0.5 for the median
  static double most(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values.empty() ? kInfinity : values[std::min<std::size_t>(share * values.size(), values.size() - 1)];
  }
};

// The largest errors of 95 % of the walks, and what is said of them. The middle of the truth's heads is the nominal one
// but for the last row.
TEST(HeadRegistration, FindsTheTruthAsWellAsItSays) {
  struct Row {
    const char* name;
    WalkSettings walk;
    double yaw, level, height, head;  // [degrees], [mm]
    int refused;
  };
  const std::vector<Row> rows = {
      {"5 s, 5 m", {}, 0.6, 18, 22, 21, 0},
      {"5 s, 2 m", {.distance = 2.0}, 1.0, 18, 22, 15, 8},
      {"5 s, 1 m", {.distance = 1.0}, 1.7, 18, 22, 13, 45},
      {"10 s, 8 m", {.seconds = 10.0, .distance = 8.0}, 0.25, 10, 20, 13, 0},
      {"20 s, 16 m", {.seconds = 20.0, .distance = 16.0}, 0.1, 6, 17, 9, 0},
      {"10 s, 8 m in a room", {.seconds = 10.0, .distance = 8.0, .room = 1.0}, 0.3, 10, 20, 12, 0},
      {"straight line, 4 m", {.distance = 4.0, .shape = Shape::kLine}, 0.8, 70, 22, 12, 0},
      {"40 % dropouts", {.dropouts = 0.4}, 0.8, 22, 22, 23, 0},
      {"10 % outliers", {.outliers = 0.1}, 0.6, 18, 22, 21, 0},
      {"120 ms", {.lag = 0.12}, 0.6, 20, 22, 21, 0},
      {"30 mm noise", {.noise = 0.03}, 1.1, 35, 22, 36, 5},
      {"noise that lasts, 10 s", {.seconds = 10.0, .distance = 8.0, .lasting = 0.6}, 0.4, 14, 22, 19, 0},
      {"head 41 mm elsewhere", {.head = Vec3(0.0, -0.06, 0.09)}, 0.6, 19, 26, 21, 0}};
  for (const Row& row : rows) {
    const Trials trials(row.walk);
    SCOPED_TRACE(row.name);
    EXPECT_LE(trials.refused, row.refused);
    EXPECT_LE(Trials::most(trials.yaw, 0.95), row.yaw);
    EXPECT_LE(Trials::most(trials.level, 0.95), row.level);
    EXPECT_LE(Trials::most(trials.height, 0.95), row.height);
    EXPECT_LE(Trials::most(trials.head, 0.95), row.head);
    EXPECT_LE(Trials::most(trials.lag, 0.95), 35.0);
    // Deviations are neither too small nor much too large.
    for (const auto* ratio : {&trials.yawRatio, &trials.levelRatio, &trials.heightRatio}) {
      EXPECT_LE(Trials::most(*ratio, 0.95), 2.5);
      EXPECT_GE(Trials::most(*ratio, 0.95), 1.0);
    }
    std::cout << fmt::format("{:24} ", row.name);
    for (const auto* values : {&trials.yaw, &trials.yawSaid}) {
      std::cout << fmt::format("{:.2f}/{:.2f} ", Trials::most(*values, 0.5), Trials::most(*values, 0.95));
    }
    for (const auto* values : {&trials.level, &trials.levelSaid, &trials.height, &trials.head, &trials.lag}) {
      std::cout << fmt::format("{:.1f}/{:.1f} ", Trials::most(*values, 0.5), Trials::most(*values, 0.95));
    }
    for (const auto* ratio : {&trials.yawRatio, &trials.levelRatio, &trials.heightRatio}) {
      std::cout << fmt::format("{:.1f} ", Trials::most(*ratio, 0.95));
    }
    std::cout << trials.refused << " refused\n";
  }
}

TEST(HeadRegistration, WithoutNoiseTheTruthIsFound) {
  for (int seed = 1; seed <= 20; ++seed) {
    const VirtualWalk walk({.seconds = 10.0, .distance = 8.0, .noise = 0.0, .dropouts = 0.0, .outliers = 0.0}, seed);
    const Registration found = test::valueOf(solved(walk));
    const test::RegistrationErrors errors = errorsOf(found, walk);
    EXPECT_LT(errors.yaw, 0.03 * kDegree) << seed;
    EXPECT_LT(errors.level, 0.002) << seed;
    EXPECT_LT(errors.head, 0.002) << seed;
    EXPECT_LT(errors.lag, 0.003) << seed;
    // The frames agree in what they say of one place.
    const auto& pose = walk.poses[100];
    const Vec3 head = found.headInFloor(pose.position, pose.orientation);
    EXPECT_LT((found.stageFromFloor() * head - pose.position - pose.orientation * found.headInHeadset).norm(), 1e-12);
  }
}

TEST(HeadRegistration, WhoDoesNotWalkIsRefused) {
  for (const Shape shape : {Shape::kStand, Shape::kTurnHead, Shape::kTurnAndNod}) {
    for (int seed = 1; seed <= Trials::kCount; ++seed) {
      const double seconds = seed % 5 == 0 ? 20.0 : 5.0;
      const Result<Registration> found = solved(VirtualWalk({.seconds = seconds, .shape = shape}, seed));
      ASSERT_FALSE(found.ok()) << seed;
      test::expectAll(found.error().message, {"yaw", "expected 1", "you stand still", "walk a curve", "look around"});
    }
  }
}

TEST(HeadRegistration, AStraightLineIsSaidToLeaveTheLevelOpen) {
  int said = 0;
  for (int seed = 1; seed <= Trials::kCount; ++seed) {
    const Registration line = test::valueOf(solved(VirtualWalk({.distance = 4.0, .shape = Shape::kLine}, seed)));
    EXPECT_GT(line.levelDeviation, 0.03);
    EXPECT_TRUE(test::has(adviceFor(line), "walk a curve"));
    said += adviceFor(test::valueOf(solved(VirtualWalk({}, seed)))).empty() ? 0 : 1;
  }
  EXPECT_LT(said, 3) << "a walk in a curve needs no advice";
}

TEST(HeadRegistration, TooLittleIsASentence) {
  HeadRegistration registration;
  EXPECT_TRUE(test::has(registration.solve().error().message, "0 of 0 tracked heads"));
  EXPECT_FALSE(registration.hasMoved(Registration()));
  registration.addTracked(1.0, Vec3(0.0, 1.6, 0.0));
  EXPECT_TRUE(test::has(registration.solve().error().message, "0 of 1 tracked heads"));
  EXPECT_FALSE(registration.hasMoved(Registration()));
  registration.addHeadset(1.0, Vec3(0.0, 1.6, 0.0), Quat::Identity());
  EXPECT_TRUE(test::has(registration.solve().error().message, "poses of the headset (1)"));
  EXPECT_FALSE(registration.hasMoved(Registration()));
  // Neither the tracker without the headset nor the headset without the tracker is enough, nor both at other times.
  VirtualWalk walk({}, 1);
  const VirtualWalk whole = walk;
  walk.poses.clear();
  EXPECT_FALSE(solved(walk).ok());
  walk.poses = whole.poses;
  for (auto& pose : walk.poses) pose.time += 100.0;
  EXPECT_FALSE(solved(walk).ok());
  walk.heads.clear();
  EXPECT_FALSE(solved(walk).ok());
}

TEST(HeadRegistration, AHeadThatStaysAtOnePointIsRefused) {
  HeadRegistration registration;
  for (int i = 0; i < 1000; ++i) {
    registration.addHeadset(0.01 * i, Vec3(1.0, 1.6, 2.0), Quat::Identity());
    registration.addTracked(0.01 * i, Vec3(0.0, 1.54, 0.0));
  }
  EXPECT_TRUE(test::has(registration.solve().error().message, "you stand still"));
}

TEST(HeadRegistration, AnotherPersonsHeadAndAnotherFloorAreRefused) {
  for (int seed = 1; seed <= 20; ++seed) {
    VirtualWalk walk({.seconds = 10.0, .distance = 8.0}, seed);
    const auto heads = walk.heads;
    walk.heads = VirtualWalk({.seconds = 10.0, .distance = 8.0}, seed + 1000).heads;
    const Result<Registration> other = solved(walk);
    ASSERT_FALSE(other.ok()) << seed;
    EXPECT_TRUE(test::has(other.error().message, "only the one who wears the headset")) << seed;
    walk.heads = heads;
    for (auto& head : walk.heads) head.position.y() += 1.5;
    EXPECT_TRUE(test::has(solved(walk).error().message, "floors")) << seed;
  }
}

TEST(HeadRegistration, TheSameSamplesGiveTheSameBits) {
  const VirtualWalk walk({}, 7);
  const Registration found = test::valueOf(solved(walk));
  EXPECT_EQ(bitsOf(test::valueOf(solved(walk))), bitsOf(found));
  // Whichever comes first.
  HeadRegistration registration;
  for (const auto& pose : walk.poses) registration.addHeadset(pose.time, pose.position, pose.orientation);
  for (const auto& head : walk.heads) registration.addTracked(head.time, head.position);
  EXPECT_EQ(bitsOf(test::valueOf(registration.solve())), bitsOf(found));
}

TEST(HeadRegistration, SamplesThatCannotBeAreIgnored) {
  const VirtualWalk walk({}, 7);
  HeadRegistration registration;
  for (const auto& pose : walk.poses) {
    registration.addHeadset(pose.time, pose.position, Quat(3.0 * pose.orientation.coeffs() / 2.0));
    registration.addHeadset(pose.time, pose.position + Vec3::UnitX(), pose.orientation);  // not later
    registration.addHeadset(pose.time - 0.5, Vec3::Zero(), pose.orientation);
    registration.addHeadset(kNan, pose.position, pose.orientation);
    registration.addHeadset(kInfinity, pose.position, pose.orientation);
    registration.addHeadset(pose.time + 0.001, Vec3(0.0, kNan, 0.0), pose.orientation);
    registration.addHeadset(pose.time + 0.001, Vec3(1e300, 0.0, 0.0), pose.orientation);
    registration.addHeadset(pose.time + 0.001, pose.position, Quat(0.0, 0.0, 0.0, 0.0));
    registration.addHeadset(pose.time + 0.001, pose.position, Quat(kNan, 0.0, 0.0, 0.0));
    registration.addHeadset(pose.time + 0.001, pose.position, Quat(1e200, 0.0, 1e200, 0.0));
  }
  for (const auto& head : walk.heads) {
    registration.addTracked(head.time, head.position);
    registration.addTracked(head.time, Vec3::Zero());
    registration.addTracked(head.time - 0.5, Vec3::Zero());
    registration.addTracked(-kInfinity, head.position);
    registration.addTracked(kNan, head.position);
    registration.addTracked(head.time + 0.001, Vec3(kNan, kInfinity, 0.0));
    registration.addTracked(head.time + 0.001, Vec3(0.0, 0.0, -1e9));
  }
  const test::RegistrationErrors errors = errorsOf(test::valueOf(registration.solve()), walk),
                                 clean = errorsOf(test::valueOf(solved(walk)), walk);
  EXPECT_NEAR(errors.yaw, clean.yaw, 1e-9);
  EXPECT_NEAR(errors.level, clean.level, 1e-9);
}

TEST(HeadRegistration, NonsenseIsRefusedOrAnswered) {
  for (int seed = 1; seed <= 100; ++seed) {
    RandomNumbers random(seed);
    const double size = std::pow(10.0, random.between(-8.0, 2.5)), step = std::pow(10.0, random.between(-9.0, -1.0));
    const auto place = [&] { return Vec3(size * random.unit(), size * random.unit(), size * random.unit()); };
    HeadRegistration registration;
    for (int i = 0; i < 300; ++i) {
      const double time = (i < 150 ? 1e6 : 1e6 + 1.0) + step * i;
      registration.addHeadset(time, place(), Quat(random.unit(), random.unit(), -random.unit(), random.unit()));
      registration.addTracked(time + step * random.unit(), place());
    }
    const Result<Registration> found = registration.solve();
    if (found) {
      EXPECT_TRUE(found->translation.allFinite() && found->levelDeviation > 0.0) << seed;
    }
    (void)registration.hasMoved(found ? *found : Registration());
    EXPECT_FALSE(registration.solve(Registration{.yaw = 1e9, .translation = Vec3(1e3, 0.0, 1e3)}).ok()) << seed;
  }
}

TEST(HeadRegistration, AClockThatIsSetBackStartsAnew) {
  const VirtualWalk before({.seconds = 20.0, .distance = 16.0}, 1), after({}, 2);
  HeadRegistration registration;
  before.walk(registration);
  after.walk(registration);
  EXPECT_EQ(bitsOf(test::valueOf(registration.solve())), bitsOf(test::valueOf(solved(after))));
  registration.restart();
  EXPECT_FALSE(registration.solve().ok());
}

TEST(HeadRegistration, ForgetsWhatIsOlderThanAMinute) {
  const VirtualWalk before({.seconds = 10.0, .distance = 8.0}, 1);
  VirtualWalk after({.seconds = 60.0, .distance = 40.0}, 2);
  for (auto& head : after.heads) head.time += 20.0;
  for (auto& pose : after.poses) pose.time += 20.0;
  HeadRegistration registration;
  before.walk(registration);
  after.walk(registration);
  EXPECT_EQ(bitsOf(test::valueOf(registration.solve())), bitsOf(test::valueOf(solved(after))));
}

TEST(HeadRegistration, AddingAllocatesNothing) {
  HeadRegistration registration;
  const long before = test::allocationCount();
  for (int i = 0; i < 200'000; ++i) {
    registration.addHeadset(0.005 * i, Vec3(0.0, 1.6, 0.0), Quat::Identity());
    registration.addTracked(0.005 * i, Vec3(0.0, 1.6, 0.0));
  }
  registration.restart();
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(HeadRegistration, IsRefinedFromWhatIsNearlyRight) {
  for (int seed = 1; seed <= 20; ++seed) {
    const VirtualWalk walk({.seconds = 10.0, .distance = 8.0}, seed);
    HeadRegistration registration;
    walk.walk(registration);
    const Registration found = test::valueOf(registration.solve());
    Registration near = found;
    near.yaw += 0.1;
    near.translation += Vec3(0.05, 0.02, -0.05);
    near.lag += 0.03;
    near.headInHeadset = kNominalHeadInHeadset;
    const Registration refined = test::valueOf(registration.solve(near));
    EXPECT_NEAR(refined.yaw, found.yaw, 1e-3) << seed;
    EXPECT_LT((refined.translation - found.translation).norm(), 1e-3) << seed;
    EXPECT_LT((refined.headInHeadset - found.headInHeadset).norm(), 1e-3) << seed;
    EXPECT_NEAR(refined.levelDeviation, found.levelDeviation, 1e-4) << seed;
  }
}

/// Somebody registers within 10 s and goes on walking.
/// @return when it is said that the camera has moved, asked ten times a second; infinite if never
double movedSaidAt(const VirtualWalk& walk) {
  HeadRegistration registration;
  Result<Registration> known = unsupported("not yet");
  std::size_t head = 0;
  double asked = 10.0;
  for (const auto& pose : walk.poses) {
    for (; head < walk.heads.size() && walk.heads[head].time < pose.time; ++head) {
      registration.addTracked(walk.heads[head].time, walk.heads[head].position);
    }
    registration.addHeadset(pose.time, pose.position, pose.orientation);
    if (pose.time < asked) continue;
    asked += 0.1;
    if (!known) known = registration.solve();
    if (known && registration.hasMoved(*known)) return pose.time;
  }
  EXPECT_TRUE(known.ok()) << known.error().message;
  return kInfinity;
}

TEST(HeadRegistration, AMovedCameraIsNoticedWithinTwoSeconds) {
  constexpr double kMoment = 20.0;
  for (int seed = 1; seed <= 30; ++seed) {
    const VirtualWalk walk({.seconds = 25.0, .distance = 20.0, .room = 1.5}, seed);
    Vec3 place = Vec3::Zero();
    for (const auto& head : walk.heads) place = head.time < kMoment ? head.position : place;
    const Vec3 camera = place + Vec3(0.0, 0.0, 3.0);
    const Isometry3 shifted(Eigen::Translation3d(0.09, 0.0, -0.09));
    const Isometry3 turned =
        Eigen::Translation3d(camera) * Eigen::AngleAxisd(5.0 * kDegree, Vec3::UnitY()) * Eigen::Translation3d(-camera);
    for (const Isometry3& moved : {shifted, turned}) {
      VirtualWalk after = walk;
      for (auto& head : after.heads) {
        if (head.time >= kMoment) head.position = moved * head.position;
      }
      const double said = movedSaidAt(after);
      EXPECT_GT(said, kMoment) << seed;
      EXPECT_LT(said, kMoment + 2.0) << seed;
    }
    // The stage was set up anew, as by a long press of a button.
    VirtualWalk recentred = walk;
    for (auto& pose : recentred.poses) {
      if (pose.time >= kMoment) pose.position += Vec3(0.2, 0.0, 0.0);
    }
    EXPECT_LT(movedSaidAt(recentred), kMoment + 2.0) << seed;
  }
}

TEST(HeadRegistration, ACameraThatStaysIsNeverSaidToHaveMoved) {
  for (int seed = 1; seed <= 30; ++seed) {
    EXPECT_EQ(movedSaidAt(VirtualWalk({.seconds = 70.0, .distance = 50.0, .room = 1.5}, seed)), kInfinity) << seed;
  }
  for (int seed = 1; seed <= 10; ++seed) {
    const WalkSettings rough{.seconds = 70.0,
                             .distance = 50.0,
                             .room = 1.5,
                             .noise = 0.03,
                             .lasting = 0.6,
                             .dropouts = 0.4,
                             .outliers = 0.1,
                             .drift = 0.03};
    EXPECT_EQ(movedSaidAt(VirtualWalk(rough, seed)), kInfinity) << seed;
  }
}

TEST(FacesAway, TheHeadsetTellsFrontFromBack) {
  const VirtualWalk walk({.seconds = 10.0, .distance = 8.0}, 3);
  const Registration found = test::valueOf(solved(walk));
  const Isometry3 stageFromFloor = walk.truth.stageFromFloor();
  for (const double yaw : {-3.0, -1.0, 0.0, 2.0}) {
    // The body turned by `yaw` faces +Z turned by it, a headset on it looks there.
    const Vec3 facing(std::sin(yaw), 0.0, std::cos(yaw));
    for (const double look : {-1.2, 0.0, 1.2}) {
      for (const double nod : {-1.5, 0.0, 1.5}) {
        const Mat3 floorFromHeadset(Eigen::AngleAxisd(yaw + look + std::numbers::pi, Vec3::UnitY()) *
                                    Eigen::AngleAxisd(nod, Vec3::UnitX()));
        const Quat orientation(Mat3(stageFromFloor.linear() * floorFromHeadset));
        EXPECT_FALSE(facesAway(found, orientation, facing)) << yaw << " " << look << " " << nod;
        EXPECT_TRUE(facesAway(found, orientation, -facing)) << yaw << " " << look << " " << nod;
      }
    }
  }
}

}  // namespace
}  // namespace lorica
