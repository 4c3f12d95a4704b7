#include "viewer/player/headset_link.h"

#include "tests/capture/registration/virtual_walk.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

namespace lorica {
namespace {

/// A client whose clock is another than ours, and a camera, both of a walk.
class Wearer {
 public:
  explicit Wearer(std::uint64_t seed, double start = 1000.0) : walk_(settings(), seed), start_(start) {
    ::setenv("XDG_CONFIG_HOME", home_.path().c_str(), 1);
  }
  static test::WalkSettings settings() {
    test::WalkSettings walk;
    walk.seconds = 10.0;
    walk.distance = 8.0;
    return walk;
  }
  /// Hands all of it over in the order of time. @return the last message, of those that are any
  /// @param other  somebody else before the camera, who wears no headset and has the first place
  WearerState wear(HeadsetLink& link, const Isometry3& moved = Isometry3::Identity(),
                   const test::VirtualWalk* other = nullptr) {
    std::size_t others = 0;
    std::size_t pose = 0;
    WearerState last;
    const auto keep = [&](const std::optional<WearerState>& news) { last = news.value_or(last); };
    for (const HeadRegistration::TrackedHead& head : walk_.heads) {
      for (; pose < walk_.poses.size() && walk_.poses[pose].time <= head.time; ++pose) {
        const HeadRegistration::HeadsetPose& at = walk_.poses[pose];
        HeadsetPose heard;
        heard.wearer = 4;
        heard.pose.time = start_ + at.time - 77.0;
        heard.pose.head = Eigen::Translation3d(at.position) * at.orientation;
        // The network takes a millisecond, sometimes more.
        link.addHeadset(heard, start_ + at.time + (pose % 7 == 0 ? 0.02 : 0.001));
      }
      for (; other != nullptr && others < other->heads.size() && other->heads[others].time <= head.time; ++others) {
        link.addTracked(0, other->heads[others].position, start_ + other->heads[others].time);
      }
      link.addTracked(other != nullptr ? 1 : 0, moved * head.position, start_ + head.time);
      // Solving takes no time of this clock.
      do {
        keep(link.update(start_ + head.time));
        std::this_thread::yield();
      } while (link.solving());
    }
    start_ += walk_.heads.back().time + 1.0;
    return last;
  }
  [[nodiscard]] const test::VirtualWalk& walk() const { return walk_; }

 private:
  test::TemporaryFolder home_;
  test::VirtualWalk walk_;
  double start_;
};

TEST(HeadsetLink, FindsHowTheHeadsetLiesToTheCamera) {
  Wearer wearer(5);
  HeadsetLink link;
  const auto worn = std::make_shared<WornHeadset>();
  link.begin("camera 1", worn);
  const WearerState told = wearer.wear(link);
  ASSERT_TRUE(told.registration) << told.advice;
  ASSERT_TRUE(worn->registration()) << "the tracker is told";
  EXPECT_EQ(worn->registration()->yaw, link.known()->yaw);
  EXPECT_NEAR(told.registration->yaw, wearer.walk().truth.yaw, 0.5 * 0.0174533);
  ASSERT_TRUE(link.known());
  EXPECT_LT(test::errorsOf(*link.known(), wearer.walk()).level, 0.02);
  EXPECT_LT(told.registration->yawDeviation, HeadRegistration::kMaxYawDeviation);
}

TEST(HeadsetLink, FindsWhoOfSeveralPeopleWearsIt) {
  Wearer wearer(5);
  const test::VirtualWalk other(Wearer::settings(), 11);
  HeadsetLink link;
  link.begin("camera 1", std::make_shared<WornHeadset>());
  const WearerState told = wearer.wear(link, Isometry3::Identity(), &other);
  ASSERT_TRUE(link.known()) << told.advice;
  EXPECT_EQ(link.place(), 1);
  EXPECT_LT(test::errorsOf(*link.known(), wearer.walk()).level, 0.02);
  // The same two go on: nobody is taken for a camera that was moved.
  EXPECT_TRUE(wearer.wear(link, Isometry3::Identity(), &other).registration);
  EXPECT_EQ(link.place(), 1);
}

TEST(HeadsetLink, WhatWasFoundIsKeptForTheCamera) {
  Wearer wearer(6);
  HeadsetLink link;
  link.begin("camera 1", std::make_shared<WornHeadset>());
  ASSERT_TRUE(wearer.wear(link).registration);
  HeadsetLink again, other;
  again.begin("camera 1", std::make_shared<WornHeadset>());
  ASSERT_TRUE(again.known());
  EXPECT_EQ(again.known()->yaw, link.known()->yaw);
  other.begin("camera 2", std::make_shared<WornHeadset>());
  EXPECT_FALSE(other.known());
}

TEST(HeadsetLink, AMovedCameraIsNoticedAndFoundAgain) {
  Wearer wearer(7);
  HeadsetLink link;
  link.begin("camera 1", std::make_shared<WornHeadset>());
  ASSERT_TRUE(wearer.wear(link).registration);
  const Isometry3 moved(Eigen::Translation3d(0.5, 0.0, 0.2) * Eigen::AngleAxisd(0.4, Vec3::UnitY()));
  const WearerState told = wearer.wear(link, moved);
  ASSERT_TRUE(told.registration) << told.advice;
  // Stage from floor turns back by what the camera was turned.
  const double change = link.known()->yaw - (wearer.walk().truth.yaw - 0.4);
  EXPECT_NEAR(std::remainder(change, 2.0 * EIGEN_PI), 0.0, 1.0 * 0.0174533);
}

TEST(HeadsetLink, WhatIsForgottenIsFoundAgain) {
  Wearer wearer(9);
  HeadsetLink link;
  const auto worn = std::make_shared<WornHeadset>();
  link.forget();
  link.begin("camera 1", worn);
  ASSERT_TRUE(wearer.wear(link).registration);
  link.forget();
  EXPECT_FALSE(link.known());
  EXPECT_FALSE(worn->registration()) << "the tracker is told";
  EXPECT_FALSE(link.place());
  EXPECT_TRUE(wearer.wear(link).registration);
  EXPECT_LT(test::errorsOf(*link.known(), wearer.walk()).level, 0.02);
}

TEST(HeadsetLink, NothingIsSaidWithoutACameraOrAHeadset) {
  Wearer wearer(8);
  HeadsetLink link;
  link.begin("", nullptr);
  HeadsetPose heard;
  heard.wearer = 1;
  for (int i = 0; i < 100; ++i) {
    link.addHeadset(heard, 0.1 * i);
    EXPECT_FALSE(link.update(0.1 * i));
  }
  link.begin("camera 1", std::make_shared<WornHeadset>());
  for (int i = 0; i < 100; ++i) {
    link.addTracked(0, Vec3::UnitY(), 0.1 * i);
    EXPECT_FALSE(link.update(0.1 * i));
  }
}

}  // namespace
}  // namespace lorica
