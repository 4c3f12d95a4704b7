#include "skinning/springs/spring_collider.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lorica::test {
namespace {

Affine3 somewhere() {
  return Eigen::Translation3d(0.4, -0.2, 1.0) * Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized()) *
         Eigen::Scaling(1.5);
}

/// Distance to a segment by trying many of its points.
double distanceToSegment(const Vec3& a, const Vec3& b, const Vec3& p) {
  double least = kInfinity;
  for (int i = 0; i <= 20000; ++i) least = std::min(least, (a + (b - a) * (i / 20000.0) - p).norm());
  return least;
}

TEST(SpringCollider, BallsAreMovedToTheSurface) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Affine3 world = somewhere();
  const auto point = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    for (const SpringColliderShape shape : {SpringColliderShape::kSphere, SpringColliderShape::kCapsule,
                                            SpringColliderShape::kInsideSphere, SpringColliderShape::kInsideCapsule}) {
      const SpringCollider collider{.shape = shape, .offset = 0.3 * point(), .tail = 0.3 * point(), .radius = 0.6};
      const Vec3 center = world * point();
      const auto hit = hitCollider(collider, world, center, 0.1);
      const bool round = shape == SpringColliderShape::kSphere || shape == SpringColliderShape::kInsideSphere;
      const bool inside = shape == SpringColliderShape::kInsideSphere || shape == SpringColliderShape::kInsideCapsule;
      const Vec3 begin = world * collider.offset;
      const Vec3 end = round ? begin : Vec3(world * collider.tail);
      const double distance = distanceToSegment(begin, end, center);
      const double depth = inside ? distance - (0.6 - 0.1) : 0.6 + 0.1 - distance;
      ASSERT_EQ(hit.has_value(), depth > 0.0);
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(hit->depth, depth, 1e-6);
      EXPECT_NEAR(hit->direction.norm(), 1.0, 1e-12);
      const double after = distanceToSegment(begin, end, center + hit->depth * hit->direction);
      EXPECT_NEAR(after, inside ? 0.5 : 0.7, 1e-6);
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(SpringCollider, APlaneKeepsBallsOnItsSide) {
  Affine3 world = somewhere();
  world.linear() = world.linear() * Vec3(1.0, 3.0, 0.5).asDiagonal();
  const Vec3 normal = Vec3(1.0, 1.0, 1.0).normalized();
  const SpringCollider plane{.shape = SpringColliderShape::kPlane, .offset = Vec3(0.1, 0.2, 0.3), .normal = normal};
  // Two directions within the plane, moved by the matrix, span the plane in the world.
  const Vec3 u = world.linear() * normal.unitOrthogonal();
  const Vec3 v = world.linear() * normal.cross(normal.unitOrthogonal());
  Vec3 worldNormal = u.cross(v).normalized();
  if (worldNormal.dot(world.linear() * normal) < 0.0) worldNormal = -worldNormal;
  const Vec3 on = world * plane.offset;
  EXPECT_FALSE(hitCollider(plane, world, on + 0.11 * worldNormal + 2.0 * u, 0.1));
  const auto hit = hitCollider(plane, world, on - 0.3 * worldNormal + 2.0 * u, 0.1);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->depth, 0.4, 1e-12);
  EXPECT_NEAR((hit->direction - worldNormal).norm(), 0.0, 1e-12);
}

TEST(SpringCollider, TheCentreOfASphereHasNoWayOut) {
  EXPECT_FALSE(hitCollider({.radius = 0.5}, Affine3::Identity(), Vec3::Zero(), 0.1));
}

}  // namespace
}  // namespace lorica::test
