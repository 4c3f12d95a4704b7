#include "collision/live/live_part.h"

#include "tests/collision/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;
using test::moveTo;
using test::uniform;
using test::uniformRotation;
using test::uniformVec3;

constexpr double kFrame = 1.0 / 30.0;

Isometry3 randomPosition(std::mt19937_64& random) {
  return Eigen::Translation3d(uniformVec3(random, -2.0, 2.0)) * uniformRotation(random);
}

/// A rotation about an axis through the origin of the part, and a shift: both in world axes.
Isometry3 movedBy(const Isometry3& pose, const Vec3& axis, double angle, const Vec3& shift) {
  Isometry3 next = pose;
  next.linear() = Eigen::AngleAxisd(angle, axis) * pose.linear();
  next.translation() += shift;
  return next;
}

TEST(LivePart, AStillPartHasNoVelocity) {
  std::mt19937_64 random(1);
  LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
  moveTo(part, part.worldFromPart);
  for (int i = 0; i < 100; ++i) EXPECT_LT(velocityAt(part, uniformVec3(random, -3.0, 3.0), kFrame).norm(), 1e-12);
}

TEST(LivePart, SmallTurnsGiveVPlusOmegaCrossR) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 200; ++i) {
    LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
    const Vec3 velocity = uniformVec3(random, -5.0, 5.0);
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    const double angle = 1e-5;
    const Vec3 omega = angle / kFrame * axis;
    moveTo(part, movedBy(part.worldFromPart, axis, angle, kFrame * velocity));
    const Vec3 point = part.worldFromPart * uniformVec3(random, -0.5, 0.5);
    const Vec3 expected = velocity + omega.cross(Vec3(point - part.worldFromPart.translation()));
    // The chord differs from the tangent by half the squared angle times the distance: 1e-10 / 2 * 0.9 m per frame.
    EXPECT_LT((velocityAt(part, point, kFrame) - expected).norm(), 1e-10 / kFrame) << "case " << i;
  }
}

TEST(LivePart, LargeTurnsGiveThePathOfTheMaterialOverTheFrame) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
    const Isometry3 before = part.worldFromPart;
    const Isometry3 after = randomPosition(random);
    moveTo(part, after);
    const Vec3 own = uniformVec3(random, -0.5, 0.5);
    const double seconds = uniform(random, 0.001, 0.1);
    const Vec3 expected = (after * own - before * own) / seconds;
    EXPECT_LT((velocityAt(part, after * own, seconds) - expected).norm(), 1e-9 / seconds) << "case " << i;
  }
}

TEST(LivePart, TheWorldHullIsTheShapeInItsPose) {
  std::mt19937_64 random(4);
  const LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
  const ConvexHull hull = worldHull(part);
  ASSERT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.triangles, part.shape.triangles);
  EXPECT_EQ(hull.pointOfVertex, part.shape.pointOfVertex);
  EXPECT_EQ(hull.volume, part.shape.volume);
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3 own = part.worldFromPart.linear().transpose() * (hull.vertices[v] - part.worldFromPart.translation());
    EXPECT_LT((own.cwiseAbs() - Vec3(0.1, 0.2, 0.3)).norm(), 1e-12);
  }
}

TEST(LivePart, WhatStandsStillSweepsItself) {
  std::mt19937_64 random(5);
  LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), randomPosition(random));
  moveTo(part, part.worldFromPart);
  const ConvexHull swept = sweptHull(part);
  EXPECT_NEAR(swept.volume, 8 * 0.1 * 0.2 * 0.3, 1e-12);
}

TEST(LivePart, ASweptBoxIsALongerBox) {
  LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), at(1, 2, 3));
  moveTo(part, at(1.5, 2, 3));
  EXPECT_NEAR(sweptHull(part).volume, (0.2 + 0.5) * 0.4 * 0.6, 1e-12);
}

TEST(LivePart, ASweptBallIsACapsule) {
  const double radius = 0.1;
  const double length = 0.5;
  LivePart part = makeBoxPart(Vec3::Constant(0.1), at(0, 1, 0));
  const int rings = 60;
  const int segments = 90;
  test::reshape(part, test::makeSphere(radius, rings, segments).vertices);
  part.reshaped = false;
  const auto capsule = [&](double r) {
    return std::numbers::pi * r * r * (length + 4.0 / 3.0 * r);  // cylinder, and a ball cut in two
  };
  // The points are on the ball. Their hull contains the ball that is smaller by the sagitta of the widest gap.
  const double gap = std::hypot(0.5 * std::numbers::pi / rings, std::numbers::pi / segments);
  std::mt19937_64 random(6);
  for (int i = 0; i < 20; ++i) {
    const Vec3 direction = uniformRotation(random) * Vec3::UnitX();
    moveTo(part, Eigen::Translation3d(length * direction) * part.worldFromPart);
    const double volume = sweptHull(part).volume;
    EXPECT_LE(volume, capsule(radius));
    EXPECT_GE(volume, capsule(radius * std::cos(gap)));
  }
}

TEST(LivePart, TheSweptHullHoldsBothEndsThoughTheShapeChanged) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 100; ++i) {
    LivePart part = makeBoxPart(uniformVec3(random, 0.02, 0.3), randomPosition(random));
    const ConvexHull before = worldHull(part);
    moveTo(part, movedBy(part.worldFromPart, uniformRotation(random) * Vec3::UnitX(), uniform(random, 0.0, 1.0),
                         uniformVec3(random, -0.3, 0.3)));
    part.reshaped = false;
    if (i % 2 == 0) test::reshapeToBox(part, uniformVec3(random, 0.02, 0.3));
    const ConvexHull swept = sweptHull(part);
    std::vector<Vec3> points;
    sweptPoints(part, points);
    EXPECT_EQ(points.size(), before.vertices.size() + part.shape.vertices.size());
    EXPECT_EQ(convexHull(points).vertices, swept.vertices);
    EXPECT_LT(largestViolation(swept, before.vertices), 1e-9) << "case " << i;
    EXPECT_LT(largestViolation(swept, worldHull(part).vertices), 1e-9) << "case " << i;
  }
}

TEST(LivePart, ItsVelocityTakesThePreviousFrameToThePresentOne) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 1000; ++i) {
    LivePart part = makeBoxPart(uniformVec3(random, 0.02, 0.3), randomPosition(random));
    const double angle = uniform(random, 0.0, i % 10 == 0 ? 1e-7 : 3.1);
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    moveTo(part, movedBy(part.worldFromPart, axis, angle, uniformVec3(random, -0.3, 0.3)));
    const double seconds = uniform(random, 0.001, 0.1);
    const PartVelocity velocity = velocityOf(part, seconds);
    EXPECT_LT((seconds * velocity.angular - angle * axis).norm(), 1e-8) << "case " << i;
    const Vec3 origin = part.worldFromPart.translation();
    EXPECT_LT((velocity.linear - velocityAt(part, origin, seconds)).norm(), 1e-9 / seconds) << "case " << i;
  }
  const PartVelocity rest = velocityOf(makeBoxPart(Vec3(0.1, 0.2, 0.3), at(0, 1, 0)), 0.01);
  EXPECT_EQ(rest.linear, Vec3::Zero());
  EXPECT_EQ(rest.angular, Vec3::Zero());
}

TEST(LivePart, TheFirstFrameSweepsNoEarlierShape) {
  LivePart part = makeBoxPart(Vec3(0.1, 0.2, 0.3), at(0, 1, 0));
  ASSERT_TRUE(part.reshaped);
  ASSERT_TRUE(part.previousVertices.empty());
  EXPECT_NEAR(sweptHull(part).volume, part.shape.volume, 1e-12);
}

/// Max distance by which the path of a rotating part protrudes from its swept hull.
double stickingOut(const LivePart& part, const Vec3& axis, double angle, const Vec3& shift) {
  const ConvexHull swept = sweptHull(part);
  double worst = 0.0;
  for (int k = 0; k <= 40; ++k) {
    const double t = k / 40.0;
    const Isometry3 pose = movedBy(part.previousWorldFromPart, axis, t * angle, t * shift);
    std::vector<Vec3> points;
    points.reserve(part.shape.vertices.size());
    for (const Vec3& v : part.shape.vertices) points.push_back(pose * v);
    worst = std::max(worst, largestViolation(swept, points));
  }
  return worst;
}

TEST(LivePart, ATurnLeavesTheSweptHullByItsSagittaAtMost) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 200; ++i) {
    const Vec3 half = uniformVec3(random, 0.02, 0.3);
    LivePart part = makeBoxPart(half, randomPosition(random));
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    const double angle = uniform(random, 0.0, std::numbers::pi);
    const Vec3 shift = uniformVec3(random, -0.5, 0.5);
    moveTo(part, movedBy(part.worldFromPart, axis, angle, shift));
    EXPECT_LE(stickingOut(part, axis, angle, shift), half.norm() * (1.0 - std::cos(0.5 * angle)) + 1e-9)
        << "case " << i;
  }
}

TEST(LivePart, TheSagittaOfAThinRodIsReached) {
  for (const double angle : {0.1, 0.5, 1.0, 2.0}) {
    LivePart rod = makeBoxPart(Vec3(0.5, 0.001, 0.001), at(0, 1, 0));
    moveTo(rod, movedBy(rod.worldFromPart, Vec3::UnitY(), angle, Vec3::Zero()));
    const double sagitta = 0.5 * (1.0 - std::cos(0.5 * angle));
    EXPECT_GT(stickingOut(rod, Vec3::UnitY(), angle, Vec3::Zero()), sagitta - 0.001) << angle;
  }
}

}  // namespace
}  // namespace lorica
