#include "collision/world/shape_contact.h"

#include "geometry/convex_hull.h"
#include "geometry/triangle_tree.h"
#include "tests/collision/parts.h"
#include "tests/collision/slow_depth.h"
#include "tests/support/allocations.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace lorica {
namespace {

/// A body of one part that never moves.
LiveBody bodyOf(const TriMesh& solid) {
  Decomposition decomposition;
  decomposition.vertexCount = static_cast<int>(solid.vertices.size());
  decomposition.triangleCount = static_cast<int>(solid.triangles.size());
  Part& part = decomposition.parts.emplace_back();
  part.triangles = solid.triangles;
  for (std::int32_t t = 0; t < std::ssize(solid.triangles); ++t) part.sourceTriangle.push_back(t);
  for (VertexIndex v = 0; v < std::ssize(solid.vertices); ++v) part.points.push_back(v);
  LiveBody body = LiveBody::create(std::move(decomposition)).value();
  body.update(solid.vertices);
  return body;
}

/// The distance of a point and a hull that it is outside of.
double distanceTo(const ConvexHull& hull, const Vec3& p) {
  double least = kInfinity;
  for (const Triangle& t : hull.triangles) {
    const std::array<Vec3, 3> corners = {hull.vertices[t[0]], hull.vertices[t[1]], hull.vertices[t[2]]};
    least = std::min(least, std::sqrt(nearestOnTriangle(p, corners).first));
  }
  return least;
}

/// The distance of a segment and a hull that do not meet. It is convex along the segment.
double distanceTo(const ConvexHull& hull, const Vec3& a, const Vec3& b) {
  double low = 0.0, high = 1.0;
  const auto at = [&](double s) { return distanceTo(hull, Vec3(a + s * (b - a))); };
  for (int i = 0; i < 80; ++i) {
    const double left = low + (high - low) / 3.0, right = high - (high - low) / 3.0;
    (at(left) < at(right) ? high : low) = at(left) < at(right) ? right : left;
  }
  return at(low);
}

/// The depth of a ball or a capsule in a hull; negative if they are apart.
double slowDepth(const ConvexHull& hull, std::span<const Vec3> points, double radius) {
  ConvexHull core;
  core.vertices.assign(points.begin(), points.end());
  if (points.size() == 2) core.triangles = {{0, 1, 1}};
  const double inside = test::slowDepth(hull, core);
  if (inside > 0.0) return inside + radius;
  return radius - distanceTo(hull, points.front(), points.back());
}

TEST(ShapeContact, ABallOnABoxIsAsDeepAsItsRadiusReaches) {
  const LiveBody body = bodyOf(test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  ShapeContactQuery query(body);
  Vec3 centre(0.4, 1.07, 0.5);
  const auto contacts = [&](double radius) { return query.find(body.parts(), {std::span(&centre, 1), radius}); };
  ASSERT_EQ(contacts(0.1).size(), 1U);
  const ShapeContact found = contacts(0.1)[0];
  EXPECT_EQ(found.part, 0);
  EXPECT_NEAR(found.depth, 0.03, 1e-5);
  EXPECT_LT((found.direction - Vec3::UnitY()).norm(), 1e-4);
  EXPECT_LT((found.position - Vec3(0.4, 0.985, 0.5)).norm(), 1e-4);
  EXPECT_TRUE(contacts(0.069).empty());
  // At a corner the direction is that from the corner to the centre.
  centre = Vec3::Constant(1.0) + 0.1 * Vec3(1, 2, 2);
  EXPECT_TRUE(contacts(0.299).empty());
  ASSERT_EQ(contacts(0.31).size(), 1U);
  EXPECT_NEAR(contacts(0.31)[0].depth, 0.01, 1e-5);
  EXPECT_LT((contacts(0.31)[0].direction - Vec3(1, 2, 2) / 3.0).norm(), 1e-4);
  // Its centre inside: out through the nearest face.
  centre = Vec3(0.5, 0.5, 0.8);
  ASSERT_EQ(contacts(0.1).size(), 1U);
  EXPECT_NEAR(contacts(0.1)[0].depth, 0.3, 2e-4);
  EXPECT_LT((contacts(0.1)[0].direction - Vec3::UnitZ()).norm(), 1e-2);
}

TEST(ShapeContact, CapsulesAndBallsAreAsDeepAsBruteForceSays) {
  std::mt19937_64 random(11);
  int found = 0, apart = 0, deep = 0;
  for (int solid = 0; solid < 20; ++solid) {
    std::vector<Vec3> cloud;
    for (int i = 0; i < 30; ++i) cloud.push_back(test::uniformVec3(random, -0.3, 0.3));
    const ConvexHull hull = convexHull(cloud);
    const LiveBody body = bodyOf({hull.vertices, hull.triangles});
    ShapeContactQuery query(body);
    for (int shape = 0; shape < 40; ++shape) {
      std::vector<Vec3> points(1 + static_cast<std::size_t>(shape % 2));
      for (Vec3& p : points) p = test::uniformVec3(random, -0.5, 0.5);
      const double radius = test::uniform(random, 0.02, 0.2);
      const double depth = slowDepth(hull, points, radius);
      const std::span<const ShapeContact> contacts = query.find(body.parts(), {points, radius});
      if (std::abs(depth) < 1e-4) continue;
      ASSERT_EQ(contacts.size(), depth > 0.0 ? 1U : 0U) << "solid " << solid << ", shape " << shape << ": " << depth;
      (depth > 0.0 ? found : apart) += 1;
      if (depth < 0.0) continue;
      deep += depth > radius ? 1 : 0;
      EXPECT_GE(contacts[0].depth, depth - 1e-6);  // directions have single precision
      EXPECT_LE(contacts[0].depth, 1.01 * depth + 2e-4);
      EXPECT_NEAR(test::overlapAlong(hull.vertices, points, contacts[0].direction) + radius, contacts[0].depth, 1e-6);
      EXPECT_LT(largestViolation(hull, std::span(&contacts[0].position, 1)), 0.5 * depth + 2e-4);
    }
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(apart, 100);
  EXPECT_GT(deep, 50);
}

TEST(ShapeContact, BoxesAreAsDeepAsBruteForceSays) {
  std::mt19937_64 random(12);
  const LiveBody body = bodyOf(test::makeBox(Vec3(-0.3, -0.2, -0.1), Vec3(0.3, 0.2, 0.1)));
  const ConvexHull hull = worldHull(body.parts()[0]);
  ShapeContactQuery query(body);
  int found = 0;
  for (int shape = 0; shape < 200; ++shape) {
    const Isometry3 place = Isometry3(Eigen::Translation3d(test::uniformVec3(random, -0.4, 0.4))) *
                            Isometry3(test::uniformRotation(random));
    TriMesh box = test::makeBox(Vec3(-0.1, -0.1, -0.2), Vec3(0.1, 0.1, 0.2));
    for (Vec3& p : box.vertices) p = place * p;
    const double depth = test::slowDepth(hull, convexHull(box.vertices));
    const std::span<const ShapeContact> contacts = query.find(body.parts(), {box.vertices, 0.0});
    if (std::abs(depth) < 1e-4) continue;
    ASSERT_EQ(contacts.size(), depth > 0.0 ? 1U : 0U) << depth;
    if (depth < 0.0) continue;
    ++found;
    EXPECT_GE(contacts[0].depth, depth - 1e-6);  // directions have single precision
    EXPECT_LE(contacts[0].depth, 1.01 * depth + 2e-4);
  }
  EXPECT_GT(found, 50);
}

TEST(ShapeContact, AFrameAllocatesNothing) {
  const LiveBody body = bodyOf(test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  ShapeContactQuery query(body);
  const std::vector<Vec3> points = {Vec3(0.5, 1.0, 0.5), Vec3(0.5, 2.0, 0.5)};
  EXPECT_EQ(query.find(body.parts(), {points, 0.1}).size(), 1U);
  const long before = test::allocationCount();
  EXPECT_EQ(query.find(body.parts(), {points, 0.1}).size(), 1U);
  EXPECT_EQ(test::allocationCount(), before);
}

}  // namespace
}  // namespace lorica
