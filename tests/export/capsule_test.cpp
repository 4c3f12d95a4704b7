#include "export/capsule.h"

#include "geometry/random_numbers.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lorica {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<Vec3> pointsOn(const Capsule& capsule, int count) {
  RandomNumbers random(1);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0), z = random.between(-1.0, 1.0);
    const Vec3 direction = Vec3(x, y, z).normalized();
    const bool up = direction.dot(capsule.to - capsule.from) > 0.0;
    points.push_back((up ? capsule.to : capsule.from) + capsule.radius * direction);
  }
  return points;
}

TEST(Capsule, HasTheVolumeOfABallAndACylinderAndTheDistancesOfItsSegment) {
  EXPECT_NEAR((Capsule{Vec3::Zero(), Vec3::Zero(), 0.5}.volume()), 4.0 / 3.0 * kPi * 0.125, 1e-12);
  EXPECT_NEAR((Capsule{Vec3::Zero(), Vec3(0, 2, 0), 0.5}.volume()), 4.0 / 3.0 * kPi * 0.125 + 2.0 * kPi * 0.25, 1e-12);
  const Capsule capsule{Vec3(1, 0, 0), Vec3(3, 0, 0), 0.5};
  EXPECT_NEAR(capsule.outside(Vec3(2, 2, 0)), 1.5, 1e-12);
  EXPECT_NEAR(capsule.outside(Vec3(6, 0, 4)), 4.5, 1e-12);
  EXPECT_NEAR(capsule.outside(Vec3(2, 0.1, 0)), -0.4, 1e-12);
}

TEST(Capsule, AroundPointsOfACapsuleIsNearlyThatCapsule) {
  const Capsule truth{Vec3(0.1, 0.2, 0.3), Vec3(0.5, 1.4, 0.2), 0.2};
  const std::vector<Vec3> points = pointsOn(truth, 2000);
  const Capsule found = capsuleAround(points);
  for (const Vec3& p : points) EXPECT_LE(found.outside(p), 1e-9);
  EXPECT_LT(found.volume(), 1.15 * truth.volume());
}

TEST(Capsule, HoldsAnyPointsAndNeverMuchMoreThanTheirBall) {
  RandomNumbers random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Vec3> points;
    for (int i = 0; i < 1 + trial % 9; ++i) {
      const double x = random.unit(), y = random.unit(), z = random.unit();
      points.emplace_back(x, 0.1 * y, 3.0 * z);
    }
    const Capsule capsule = capsuleAround(points);
    for (const Vec3& p : points) EXPECT_LE(capsule.outside(p), 1e-9) << "trial " << trial;
    EXPECT_LT(capsule.radius, 3.2);
  }
}

TEST(Capsule, KeepsItsMiddleWithAnotherVolume) {
  const Capsule capsule{Vec3(0, 0, 0), Vec3(0, 2, 0), 0.5};
  const Capsule small = withVolume(capsule, 0.125 * capsule.volume());
  EXPECT_NEAR(small.volume(), 0.125 * capsule.volume(), 1e-12);
  EXPECT_NEAR(small.radius, 0.25, 1e-12);
  EXPECT_NEAR((0.5 * (small.from + small.to) - Vec3(0, 1, 0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace lorica
