#include "collision/world/self_contact.h"

#include "geometry/convex_hull.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/collision/parts.h"
#include "tests/collision/slow_depth.h"
#include "tests/support/allocations.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace lorica {
namespace {

/// A mesh sequence of separate solids, each one a part.
struct Pile {
  std::vector<TriMesh> solids;
  TriMesh rest;  // of all

  void add(const TriMesh& solid) {
    solids.push_back(solid);
    rest = test::joined(rest, solid);
  }
  [[nodiscard]] LiveBody body() const {
    Decomposition decomposition;
    decomposition.vertexCount = static_cast<int>(rest.vertices.size());
    decomposition.triangleCount = static_cast<int>(rest.triangles.size());
    VertexIndex first = 0;
    std::int32_t source = 0;
    for (const TriMesh& solid : solids) {
      Part& part = decomposition.parts.emplace_back();
      for (Triangle t : solid.triangles) {
        for (VertexIndex& v : t) v += first;
        part.triangles.push_back(t);
        part.sourceTriangle.push_back(source++);
      }
      for (std::size_t v = 0; v < solid.vertices.size(); ++v) part.points.push_back(first++);
      if (decomposition.parts.size() > 1) decomposition.splitFrom.push_back(0);
    }
    return LiveBody::create(std::move(decomposition)).value();
  }
};

/// Vertex positions of a pile, with each solid moved.
std::vector<Vec3> posed(const Pile& pile, std::span<const Isometry3> motion) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < pile.solids.size(); ++i) {
    for (const Vec3& v : pile.solids[i].vertices) points.emplace_back(motion[i] * v);
  }
  return points;
}

TriMesh hullMesh(std::span<const Vec3> points) {
  ConvexHull hull = convexHull(points);
  return {std::move(hull.vertices), std::move(hull.triangles)};
}

TEST(SelfContact, OverlappingBoxesAreReportedWithDepthAndDirection) {
  Pile pile;
  pile.add(test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  pile.add(test::makeBox(Vec3(2, 0, 0), Vec3(3, 1, 1)));
  LiveBody body = pile.body();
  SelfContactQuery query(body, pile.rest.vertices);
  EXPECT_FALSE(query.areNeighbours(0, 1));
  std::vector<Isometry3> motion(2, Isometry3::Identity());
  body.update(posed(pile, motion));
  EXPECT_TRUE(query.find(body.parts()).empty());
  motion[1].translation() = Vec3(-1.2, 0.1, 0);
  body.update(posed(pile, motion));
  const std::span<const SelfContact> found = query.find(body.parts());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].first, 0);
  EXPECT_EQ(found[0].second, 1);
  EXPECT_NEAR(found[0].depth, 0.2, 1e-4);
  EXPECT_TRUE(found[0].direction.isApprox(Vec3::UnitX(), 1e-3)) << found[0].direction.transpose();
  EXPECT_NEAR(found[0].position.x(), 0.9, 0.11);
}

TEST(SelfContact, PartsThatTouchInTheRestPoseAreNeighbours) {
  Pile pile;
  pile.add(test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  pile.add(test::makeBox(Vec3(1.004, 0, 0), Vec3(2, 1, 1)));
  pile.add(test::makeBox(Vec3(2.01, 0, 0), Vec3(3, 1, 1)));
  LiveBody body = pile.body();
  SelfContactQuery query(body, pile.rest.vertices);
  EXPECT_TRUE(query.areNeighbours(0, 1));
  EXPECT_TRUE(query.areNeighbours(1, 0));
  EXPECT_FALSE(query.areNeighbours(1, 2));
  EXPECT_FALSE(query.areNeighbours(0, 2));
  std::vector<Isometry3> motion(3, Isometry3::Identity());
  motion[1].translation().x() = -0.5;
  body.update(posed(pile, motion));
  EXPECT_TRUE(query.find(body.parts()).empty());
}

TEST(SelfContact, DepthsAreThoseOfALookAlongEveryAxis) {
  std::mt19937_64 random(7);
  constexpr int kSolids = 6;
  Pile pile;
  for (int i = 0; i < kSolids; ++i) {
    std::vector<Vec3> points;
    for (int k = 0; k < 10 + 3 * i; ++k) points.push_back(Vec3(3.0 * i, 0, 0) + test::uniformVec3(random, -0.3, 0.3));
    pile.add(hullMesh(points));
  }
  LiveBody body = pile.body();
  SelfContactQuery query(body, pile.rest.vertices);
  int overlaps = 0;
  for (int pose = 0; pose < 40; ++pose) {
    std::vector<Isometry3> motion;
    for (int i = 0; i < kSolids; ++i) {
      motion.emplace_back(Eigen::Translation3d(test::uniformVec3(random, -0.5, 0.5)) * test::uniformRotation(random) *
                          Eigen::Translation3d(-3.0 * i, 0, 0));
    }
    body.update(posed(pile, motion));
    std::vector<ConvexHull> hulls;
    for (const LivePart& part : body.parts()) hulls.push_back(worldHull(part));
    const std::span<const SelfContact> found = query.find(body.parts());
    std::set<std::pair<PartIndex, PartIndex>> pairs;
    for (const SelfContact& c : found) {
      const ConvexHull& a = hulls[c.first];
      const ConvexHull& b = hulls[c.second];
      const double depth = test::slowDepth(a, b);
      EXPECT_GE(c.depth, depth - 1e-9);
      EXPECT_LE(c.depth, 1.01 * depth + 2e-4) << "pose " << pose << ": " << c.first << ", " << c.second;
      EXPECT_NEAR(test::overlapAlong(a.vertices, b.vertices, c.direction), c.depth, 1e-9);
      EXPECT_LT(largestViolation(a, std::span(&c.position, 1)), 0.5 * depth + 2e-4);
      EXPECT_LT(largestViolation(b, std::span(&c.position, 1)), 0.5 * depth + 2e-4);
      EXPECT_TRUE(pairs.emplace(c.first, c.second).second);
    }
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const SelfContact& a, const SelfContact& b) {
      return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    }));
    for (PartIndex a = 0; a < kSolids; ++a) {
      for (PartIndex b = a + 1; b < kSolids; ++b) {
        const double depth = test::slowDepth(hulls[a], hulls[b]);
        if (depth < -1e-4) {
          EXPECT_FALSE(pairs.contains({a, b})) << depth;
        }
        if (depth > 1e-4) {
          EXPECT_TRUE(pairs.contains({a, b})) << "pose " << pose << ": " << a << ", " << b << ", " << depth;
          ++overlaps;
        }
      }
    }
  }
  EXPECT_GT(overlaps, 100);
}

TEST(SelfContact, AFrameAllocatesNothing) {
  Pile pile;
  for (int i = 0; i < 5; ++i) pile.add(test::makeBox(Vec3(2.0 * i, 0, 0), Vec3(2.0 * i + 1, 1, 1)));
  LiveBody body = pile.body();
  SelfContactQuery query(body, pile.rest.vertices);
  std::vector<Isometry3> motion;
  for (int i = 0; i < 5; ++i) motion.emplace_back(Eigen::Translation3d(-1.9 * i, 0.1 * i, 0));
  body.update(posed(pile, motion));
  std::size_t found = 0;
  const long before = test::allocationCount();
  found = query.find(body.parts()).size();
  EXPECT_EQ(test::allocationCount(), before);
  EXPECT_EQ(found, 10U);
}

}  // namespace
}  // namespace lorica
