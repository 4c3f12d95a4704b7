#include "collision/world/body_contacts.h"

#include "collision/live/live_body.h"
#include "geometry/triangle_tree.h"
#include "tests/collision/parts.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>
#include <vector>

namespace lorica {
namespace {

constexpr double kFrame = 1.0 / 30.0;

/// Bodies of parts, each part of 1 kg and the index of its body more.
struct Bodies {
  std::vector<std::vector<LivePart>> parts;
  std::vector<std::vector<double>> masses;
  std::vector<BodyInWorld> views;

  std::span<const BodyInWorld> view() {
    masses.clear();
    views.clear();
    for (std::size_t b = 0; b < parts.size(); ++b) {
      masses.emplace_back(parts[b].size(), 1.0 + static_cast<double>(b));
    }
    for (std::size_t b = 0; b < parts.size(); ++b) views.push_back({parts[b], masses[b]});
    return views;
  }
};

LivePart cube(double x, double y, double z) {
  return test::makeBoxPart(Vec3::Constant(0.5), test::at(x, y, z));
}

TEST(BodyContacts, BoxesOfTwoBodiesHaveDepthVelocityAndStrength) {
  Bodies bodies;
  bodies.parts = {{cube(0, 0, 0), cube(0, 5, 0)}, {cube(1.2, 0, 0), cube(9, 9, 9)}};
  BodyContactQuery query;
  EXPECT_TRUE(query.find(bodies.view(), kFrame).empty());
  test::moveTo(bodies.parts[1][0], test::at(0.9, 0.1, 0));  // 9 m/s towards the first
  test::moveTo(bodies.parts[0][0], test::at(0.0, 0.1, 0));
  const std::span<const BodyContact> found = query.find(bodies.view(), kFrame);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].firstBody, 0);
  EXPECT_EQ(found[0].secondBody, 1);
  EXPECT_EQ(found[0].firstPart, 0);
  EXPECT_EQ(found[0].secondPart, 0);
  EXPECT_NEAR(found[0].depth, 0.1, 1e-4);
  EXPECT_TRUE(found[0].direction.isApprox(Vec3::UnitX(), 1e-4)) << found[0].direction.transpose();
  EXPECT_NEAR(found[0].position.x(), 0.45, 0.06);
  EXPECT_TRUE(found[0].relativeVelocity.isApprox(Vec3(-9, 0, 0), 1e-9)) << found[0].relativeVelocity.transpose();
  EXPECT_NEAR(found[0].strength, 9.0 * 1.0, 1e-3);  // the first weighs 1 kg, the second 2
}

TEST(BodyContacts, PartsThatLeaveRestOrJumpStrikeNothing) {
  Bodies bodies;
  bodies.parts = {{cube(0, 0, 0)}, {cube(0.5, 0, 0)}};
  BodyContactQuery query;
  EXPECT_EQ(query.find(bodies.view(), kFrame)[0].strength, 0.0);
  test::moveTo(bodies.parts[1][0], test::at(0.8, 0, 0));
  EXPECT_EQ(query.find(bodies.view(), kFrame)[0].strength, 0.0);
  test::moveTo(bodies.parts[1][0], test::at(20, 0, 0));
  test::moveTo(bodies.parts[1][0], test::at(0.8, 0, 0));
  EXPECT_EQ(query.find(bodies.view(), kFrame)[0].strength, 0.0);
}

TEST(BodyContacts, APartWithoutTrustStrikesAtHalfAMetrePerSecond) {
  Bodies bodies;
  bodies.parts = {{cube(0, 0, 0)}, {cube(1.2, 0, 0)}};
  bodies.parts[1][0].trust = 0.0;
  test::moveTo(bodies.parts[1][0], test::at(0.9, 0, 0));
  BodyContactQuery query;
  EXPECT_NEAR(query.find(bodies.view(), kFrame)[0].strength, 0.5, 1e-9);
}

TEST(BodyContacts, PartsOfOneBodyAreNoContact) {
  Bodies bodies;
  bodies.parts = {{cube(0, 0, 0), cube(0.5, 0, 0)}};
  BodyContactQuery query;
  EXPECT_TRUE(query.find(bodies.view(), kFrame).empty());
}

TEST(BodyContacts, BodiesComeGoAndMayBeFlat) {
  Bodies bodies;
  bodies.parts = {{cube(0, 0, 0)}, {cube(0.5, 0, 0)}, {cube(0.9, 0, 0)}};
  BodyContactQuery query;
  EXPECT_TRUE(query.find({}, kFrame).empty());
  EXPECT_EQ(query.find(bodies.view(), kFrame).size(), 3U);
  bodies.parts[1].clear();  // left; the others keep their numbers
  const std::span<const BodyContact> found = query.find(bodies.view(), kFrame);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].secondBody, 2);
  bodies.parts[2][0].shape.triangles.clear();
  EXPECT_TRUE(query.find(bodies.view(), kFrame).empty());
}

/// Separation of two boxes along their least overlap, by all 15 axes (Gottschalk 1996); negative if apart.
double boxDepth(const Isometry3& a, const Vec3& halfA, const Isometry3& b, const Vec3& halfB) {
  double depth = std::numeric_limits<double>::infinity();
  const auto look = [&](const Vec3& axis) {
    if (axis.norm() < 1e-9) return;
    const Vec3 n = axis.normalized();
    const auto reach = [&](const Isometry3& box, const Vec3& half) {
      return (box.linear().transpose() * n).cwiseAbs().dot(half);
    };
    depth = std::min(depth, reach(a, halfA) + reach(b, halfB) - std::abs(n.dot(b.translation() - a.translation())));
  };
  for (int i = 0; i < 3; ++i) {
    look(a.linear().col(i));
    look(b.linear().col(i));
    for (int j = 0; j < 3; ++j) look(Vec3(a.linear().col(i)).cross(Vec3(b.linear().col(j))));
  }
  return depth;
}

TEST(BodyContacts, ACrowdOfBoxesHasTheContactsOfAllPairs) {
  std::mt19937_64 random(11);
  constexpr int kBodies = 25, kParts = 5;
  Bodies bodies;
  std::vector<std::vector<Vec3>> halves(kBodies);
  for (int b = 0; b < kBodies; ++b) {
    const Vec3 middle = test::uniformVec3(random, -2.0, 2.0);
    std::vector<LivePart>& parts = bodies.parts.emplace_back();
    for (int p = 0; p < kParts; ++p) {
      halves[b].push_back(test::uniformVec3(random, 0.05, 0.4));
      const Vec3 offset = test::uniformVec3(random, -0.7, 0.7);
      const Quat turn = test::uniformRotation(random);
      parts.push_back(test::makeBoxPart(halves[b].back(), Isometry3(Eigen::Translation3d(middle + offset) * turn)));
    }
  }
  BodyContactQuery query;
  const std::span<const BodyContact> found = query.find(bodies.view(), kFrame);
  std::size_t next = 0;
  int deep = 0;
  for (int a = 0; a < kBodies; ++a) {
    for (int b = a + 1; b < kBodies; ++b) {
      for (int p = 0; p < kParts; ++p) {
        for (int q = 0; q < kParts; ++q) {
          const LivePart& first = bodies.parts[a][p];
          const LivePart& second = bodies.parts[b][q];
          const double truth = boxDepth(first.worldFromPart, halves[a][p], second.worldFromPart, halves[b][q]);
          const bool reported =
              next < found.size() && std::tie(found[next].firstBody, found[next].secondBody, found[next].firstPart,
                                              found[next].secondPart) == std::make_tuple(a, b, p, q);
          if (truth > 1e-4) {
            EXPECT_TRUE(reported) << a << " " << b << " " << p << " " << q << ": " << truth;
            ++deep;
          }
          if (!reported) continue;
          EXPECT_NEAR(found[next].depth, truth, 2e-4 + 0.01 * truth);
          // Moved by the depth along the direction, they just touch.
          Isometry3 moved = second.worldFromPart;
          moved.pretranslate(found[next].depth * found[next].direction);
          EXPECT_NEAR(boxDepth(first.worldFromPart, halves[a][p], moved, halves[b][q]), 0.0, 1e-3);
          ++next;
        }
      }
    }
  }
  EXPECT_EQ(next, found.size());
  EXPECT_GT(deep, 50);
}

/// Depth of the deepest vertex of one mesh inside the other [m]; 0 if there is none.
double deepestInside(std::span<const Vec3> points, std::span<const Vec3> other, std::span<const Triangle> triangles) {
  const TriangleTree tree(other, triangles);
  const Aabb bounds = boundsOf(other);
  double deepest = 0.0;
  for (const Vec3& p : points) {
    if ((p.array() < bounds.min.array()).any() || (p.array() > bounds.max.array()).any()) continue;
    if (tree.windingNumber(p) > 0.5) deepest = std::max(deepest, tree.distance(p));
  }
  return deepest;
}

TEST(BodyContacts, NoContactIsMissedThatTheTrueMeshesHave) {
  std::mt19937_64 random(5);
  test::Dancer a, b;
  LiveBody first = LiveBody::create(a.decomposition, a.character).value();
  LiveBody second = LiveBody::create(b.decomposition, b.character).value();
  const std::vector<double> masses(first.parts().size(), 1.0);
  BodyContactQuery query;
  int touching = 0, apart = 0;
  for (int frame = 0; frame < 24; ++frame) {
    a.dance(random, 0.5);
    b.dance(random, 0.5);
    // The second stands up to 1 m from the first.
    const Vec3 offset = a.worldFromModel[0].translation() - b.worldFromModel[0].translation() +
                        Vec3(test::uniform(random, -1.0, 1.0), 0.0, test::uniform(random, -1.0, 1.0));
    for (Affine3& joint : b.worldFromModel) joint.pretranslate(offset);
    first.update(a.worldFromModel);
    second.update(b.worldFromModel);
    const BodyInWorld views[] = {{first.parts(), masses}, {second.parts(), masses}};
    const std::span<const BodyContact> found = query.find(views, kFrame);
    const auto vertices = static_cast<std::size_t>(a.decomposition.vertexCount);
    const std::vector<Vec3> firstPoints = a.points(), secondPoints = b.points();
    const std::span<const Vec3> firstMesh = std::span(firstPoints).first(vertices);
    const std::span<const Vec3> secondMesh = std::span(secondPoints).first(vertices);
    const std::vector<Triangle>& triangles = a.character.mesh.triangles;
    const double depth =
        std::max(deepestInside(firstMesh, secondMesh, triangles), deepestInside(secondMesh, firstMesh, triangles));
    if (depth > 0.0) {
      EXPECT_FALSE(found.empty()) << "frame " << frame << ": the meshes overlap by " << depth << " m";
      ++touching;
    }
    if (found.empty()) ++apart;
  }
  EXPECT_GT(touching, 5);
  EXPECT_GT(apart, 5);
}

TEST(BodyContacts, TwoBodiesAtOnePlaceAreAContactOfEachPart) {
  test::Dancer dancer;
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  body.update(dancer.worldFromModel);
  const std::vector<double> masses(body.parts().size(), 1.0);
  const BodyInWorld views[] = {{body.parts(), masses}, {body.parts(), masses}};
  BodyContactQuery query;
  std::vector<bool> own(body.parts().size());
  for (const BodyContact& contact : query.find(views, kFrame)) {
    EXPECT_TRUE(std::isfinite(contact.depth) && contact.depth > 0.0);
    if (contact.firstPart == contact.secondPart) own[contact.firstPart] = true;
  }
  EXPECT_EQ(std::count(own.begin(), own.end(), true), std::ssize(own));
}

TEST(BodyContacts, AHeapOfBodiesIsBounded) {
  Bodies bodies;
  bodies.parts.assign(320, {cube(0, 0, 0)});  // 51,040 pairs
  BodyContactQuery query;
  EXPECT_EQ(query.find(bodies.view(), kFrame).size(), BodyContactQuery::kMaxPairs);
  EXPECT_TRUE(query.tooMany());
  bodies.parts.resize(10);
  EXPECT_EQ(query.find(bodies.view(), kFrame).size(), 45U);
  EXPECT_FALSE(query.tooMany());
}

TEST(BodyContacts, FindingAllocatesNothing) {
  Bodies bodies;
  bodies.parts = {{cube(0, 0, 0), cube(0, 1, 0)}, {cube(0.5, 0, 0)}, {cube(0.9, 0, 0)}};
  const std::span<const BodyInWorld> views = bodies.view();
  BodyContactQuery query;
  const std::size_t count = query.find(views, kFrame).size();
  const long before = test::allocationCount();
  for (int frame = 0; frame < 10; ++frame) EXPECT_EQ(query.find(views, kFrame).size(), count);
  EXPECT_EQ(test::allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica
