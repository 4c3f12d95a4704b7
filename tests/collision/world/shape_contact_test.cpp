#include "collision/world/shape_contact.h"

#include "collision/world/self_contact.h"
#include "collision/world/touch_tracker.h"
#include "geometry/convex_hull.h"
#include "geometry/triangle_tree.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/collision/parts.h"
#include "tests/support/allocations.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

/// How far the second must move along a unit direction to leave the first behind.
double overlapAlong(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& direction) {
  double high = -std::numeric_limits<double>::infinity(), low = std::numeric_limits<double>::infinity();
  for (const Vec3& v : a) high = std::max(high, v.dot(direction));
  for (const Vec3& v : b) low = std::min(low, v.dot(direction));
  return high - low;
}

/// Minimum depth of two convex polyhedra by brute force: over all face normals and all cross products of edges.
/// Negative if they are apart. A segment is a polyhedron with the triangle {0, 1, 1}.
double slowDepth(const ConvexHull& a, const ConvexHull& b) {
  double min = std::numeric_limits<double>::infinity();
  const auto look = [&](const Vec3& direction) {
    const double length = direction.norm();
    if (length > 1e-12) min = std::min(min, overlapAlong(a.vertices, b.vertices, direction / length));
  };
  std::vector<Vec3> edges[2];
  for (int side = 0; side < 2; ++side) {
    const ConvexHull& hull = side == 0 ? a : b;
    for (const Triangle& t : hull.triangles) {
      const Vec3& p = hull.vertices[t[0]];
      const Vec3& q = hull.vertices[t[1]];
      const Vec3& r = hull.vertices[t[2]];
      const Vec3 normal = (q - p).cross(r - p);
      look(side == 0 ? normal : Vec3(-normal));
      if (t[0] < t[1]) edges[side].emplace_back(q - p);
      if (t[1] < t[2]) edges[side].emplace_back(r - q);
      if (t[2] < t[0]) edges[side].emplace_back(p - r);
    }
  }
  for (const Vec3& e : edges[0]) {
    for (const Vec3& f : edges[1]) {
      look(e.cross(f));
      look(f.cross(e));
    }
  }
  return min;
}

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

constexpr double kFrame = 1.0 / 30.0;

Touch touchOf(TouchKind kind, int other, double depth = 0.01, double strength = 1.0) {
  Touch touch;
  touch.pair = {kind, 0, 1, 0, other};
  touch.bone = 5;
  touch.depth = depth;
  touch.strength = strength;
  return touch;
}

/// Phases of one contact in frames where it is touched ('x') or not ('.'), as B, S, E; '.' without an event.
std::string phases(const std::string& touched, double depth = 0.01, TouchKind kind = TouchKind::kProp) {
  TouchTracker tracker;
  std::string found;
  const Touch touch = touchOf(kind, 0, depth);
  for (std::size_t frame = 0; frame < touched.size(); ++frame) {
    const auto touches = std::span(&touch, touched[frame] == 'x' ? 1 : 0);
    const std::span<const ContactEvent> events = tracker.update(touches, static_cast<double>(frame) * kFrame);
    EXPECT_LE(events.size(), 1U);
    found += events.empty() ? '.' : "BSE"[static_cast<int>(events[0].phase)];
  }
  return found;
}

TEST(TouchTracker, AContactBeginsStaysAndEnds) {
  EXPECT_EQ(phases(".xx......"), ".BSSSE...");
}

TEST(TouchTracker, AOneFrameTouchBeginsAtOnce) {
  EXPECT_EQ(phases("x.....x"), "BSSE..B");
}

TEST(TouchTracker, ShortGapsDoNotEndAContact) {
  EXPECT_EQ(phases("x.x..x.xx..x...."), "BSSSSSSSSSSSSSE.");
}

TEST(TouchTracker, TwoPartsBeginWhenTheyOverlapByThreeMillimetres) {
  EXPECT_EQ(phases("xxx", 0.0029, TouchKind::kSelf), "...");
  EXPECT_EQ(phases("xxx", 0.0031, TouchKind::kSelf), "BSS");
  EXPECT_EQ(phases("xxx", 0.0031, TouchKind::kAvatars), "BSS");
  EXPECT_EQ(phases("xxx", 0.0, TouchKind::kProp), "BSS");
}

TEST(TouchTracker, NoiseAroundTouchingBeginsNothing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> depth(-0.0028, 0.0028);
  TouchTracker tracker;
  for (int frame = 0; frame < 300; ++frame) {
    const Touch touch = touchOf(TouchKind::kSelf, 3, depth(random));
    EXPECT_TRUE(tracker.update(std::span(&touch, touch.depth > 0.0 ? 1 : 0), frame * kFrame).empty());
  }
}

TEST(TouchTracker, AHeldContactKeepsItsPlaceWithoutDepthAndStrength) {
  TouchTracker tracker;
  Touch touch = touchOf(TouchKind::kProp, 4);
  touch.point = Vec3(1, 2, 3);
  (void)tracker.update(std::span(&touch, 1), 1.0);
  const std::span<const ContactEvent> held = tracker.update({}, 1.0 + kFrame);
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].phase, ContactPhase::kStay);
  EXPECT_EQ(held[0].touch.point, Vec3(1, 2, 3));
  EXPECT_EQ(held[0].touch.depth, 0.0);
  EXPECT_EQ(held[0].touch.strength, 0.0);
  EXPECT_EQ(held[0].time, 1.0 + kFrame);
  EXPECT_EQ(held[0].touched, 1.0);
  EXPECT_EQ(held[0].began, 1.0);
}

TEST(TouchTracker, TheBonesAreThoseOfTheBegin) {
  TouchTracker tracker;
  Touch touch = touchOf(TouchKind::kSelf, 4);
  (void)tracker.update(std::span(&touch, 1), 0.0);
  touch.bone = 6;
  touch.otherBone = 7;
  const std::span<const ContactEvent> events = tracker.update(std::span(&touch, 1), kFrame);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].touch.bone, 5);
  EXPECT_EQ(events[0].touch.otherBone, kNoJoint);
}

TEST(TouchTracker, AllContactsEndWhenTimeGoesBackOrTheStreamEnds) {
  TouchTracker tracker;
  const Touch touches[] = {touchOf(TouchKind::kProp, 0), touchOf(TouchKind::kSelf, 2)};
  (void)tracker.update(touches, 5.0);
  const std::span<const ContactEvent> back = tracker.update(std::span(touches).first(1), 1.0);
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].phase, ContactPhase::kStay);
  EXPECT_EQ(back[1].phase, ContactPhase::kEnd);
  const std::span<const ContactEvent> last = tracker.endAll();
  ASSERT_EQ(last.size(), 1U);
  EXPECT_EQ(last[0].phase, ContactPhase::kEnd);
  EXPECT_EQ(last[0].touch.pair, touches[0].pair);
  EXPECT_EQ(last[0].time, 1.0);
  EXPECT_TRUE(tracker.endAll().empty());
}

/// Random touches of 40 pairs, against a slow count of each pair on its own.
TEST(TouchTracker, ManyContactsAreTrackedAsEachAlone) {
  std::mt19937 random(3);
  constexpr int kPairs = 40, kFrames = 400;
  std::vector<std::string> touched(kPairs);
  for (std::string& frames : touched) {
    bool on = false;
    for (int frame = 0; frame < kFrames; ++frame) {
      if (random() % 5 == 0) on = !on;
      frames += on ? 'x' : '.';
    }
  }
  TouchTracker tracker;
  std::vector<std::string> found(kPairs, std::string(kFrames, '.'));
  std::vector<Touch> touches;
  for (int frame = 0; frame < kFrames; ++frame) {
    touches.clear();
    for (int pair = 0; pair < kPairs; ++pair) {
      if (touched[pair][frame] == 'x') touches.push_back(touchOf(TouchKind::kProp, pair));
    }
    for (const ContactEvent& event : tracker.update(touches, frame * kFrame)) {
      found[event.touch.pair.other][frame] = "BSE"[static_cast<int>(event.phase)];
    }
  }
  for (int pair = 0; pair < kPairs; ++pair) EXPECT_EQ(found[pair], phases(touched[pair]));
}

TEST(TouchTracker, NothingIsAllocatedOnceTheMostTouchesWereSeen) {
  TouchTracker tracker;
  std::vector<Touch> touches;
  for (int prop = 0; prop < 100; ++prop) touches.push_back(touchOf(TouchKind::kProp, prop));
  for (int frame = 0; frame < 3; ++frame) (void)tracker.update(touches, frame * kFrame);
  const long before = test::allocationCount();
  for (int frame = 3; frame < 50; ++frame) {
    (void)tracker.update(std::span(touches).first(frame % 7 == 0 ? 0 : 100), frame * kFrame);
  }
  EXPECT_EQ(test::allocationCount() - before, 0);
}

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
}  // namespace lorica::test
