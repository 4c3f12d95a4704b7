#include "collision/live/ray_query.h"

#include "collision/live/live_body.h"
#include "collision/live/live_part.h"
#include "geometry/convex_hull.h"
#include "skinning/linear_blend.h"
#include "tests/collision/parts.h"
#include "tests/support/allocations.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <vector>

namespace lorica::test {
namespace {

/// A hull in world space, and a ball around it that spares rays which miss it.
struct SlowHull {
  ConvexHull hull;
  Vec3 middle = Vec3::Zero();
  double radius = 0.0;
};

/// The same as the slow answer, to 1e-9 m; or past an edge: the slow answer for a ray 1e-9 m aside.
enum class Agreement { kSame, kGrazing, kDifferent };

struct Meeting {
  double at, u, v;
  bool front;
};
/// Where a ray meets a triangle (Moeller and Trumbore 1997).
std::optional<Meeting> meets(const HullRay& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 across = ray.direction.cross(ac);
  const double det = ab.dot(across);
  const Vec3 from = ray.origin - a;
  const Vec3 q = from.cross(ab);
  const double u = from.dot(across) / det, v = ray.direction.dot(q) / det, at = ac.dot(q) / det;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 && at >= 0.0)) return std::nullopt;
  return Meeting{at, u, v, det > 0.0};
}

bool agree(const HullHit& a, const HullHit& b, double within) {
  return static_cast<bool>(a) == static_cast<bool>(b) && std::abs(a.distance - b.distance) <= within;
}

std::vector<SlowHull> slowHulls(std::span<const LivePart> parts) {
  std::vector<SlowHull> hulls;
  for (const LivePart& part : parts) {
    SlowHull slow{worldHull(part)};
    slow.middle = boundsOf(slow.hull.vertices).center();
    for (const Vec3& v : slow.hull.vertices) slow.radius = std::max(slow.radius, (v - slow.middle).norm() + 1e-6);
    hulls.push_back(std::move(slow));
  }
  return hulls;
}

/// The nearest hit by asking every triangle of every hull; directions are unit vectors.
HullHit slowNearest(std::span<const std::vector<SlowHull>> bodies, const HullRay& ray) {
  HullHit best;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (std::size_t p = 0; p < bodies[b].size(); ++p) {
      const ConvexHull& hull = bodies[b][p].hull;
      const Vec3 way = bodies[b][p].middle - ray.origin;
      if ((way - std::max(way.dot(ray.direction), 0.0) * ray.direction).norm() > bodies[b][p].radius) continue;
      bool inside = !hull.degenerate();
      double distance = kInfinity;
      Vec3 normal = Vec3::Zero();
      for (const Triangle& triangle : hull.triangles) {
        const Vec3 &u = hull.vertices[triangle[0]], &v = hull.vertices[triangle[1]], &w = hull.vertices[triangle[2]];
        const Vec3 out = (v - u).cross(w - u);
        inside = inside && (ray.origin - u).dot(out) <= 0.0;
        const std::optional<Meeting> met = meets(ray, u, v, w);
        if (!met || !met->front || met->at >= distance) continue;
        distance = met->at;
        normal = out.normalized();
      }
      if (inside) {
        distance = 0.0;
        normal = -ray.direction;
      }
      if (distance > ray.reach || (best && distance >= best.distance)) continue;
      if (std::isfinite(distance)) {
        best = {static_cast<int>(b), static_cast<PartIndex>(p), distance, ray.origin + distance * ray.direction,
                normal};
      }
    }
  }
  return best;
}

Agreement compare(std::span<const std::vector<SlowHull>> bodies, const HullRay& ray, const HullHit& fast,
                  const HullHit& slow) {
  if (agree(fast, slow, 1e-9)) return Agreement::kSame;
  for (int side = 0; side < 6; ++side) {
    HullRay aside = ray;
    aside.origin[side / 2] += side % 2 == 0 ? 1e-9 : -1e-9;
    if (agree(fast, slowNearest(bodies, aside), 1e-6)) return Agreement::kGrazing;
  }
  return Agreement::kDifferent;
}

/// The nearest triangle from either side by asking all. @param posed  vertices of the mesh
SkinHit slowNearestOnSkin(std::span<const Vec3> posed, std::span<const Triangle> triangles, const HullRay& ray) {
  SkinHit best;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [i, j, k] = triangles[t];
    const std::optional<Meeting> met = meets(ray, posed[i], posed[j], posed[k]);
    if (!met || met->at > ray.reach || met->at >= best.distance) continue;
    best = {0,
            -1,
            static_cast<std::int32_t>(t),
            {1.0 - met->u - met->v, met->u, met->v},
            met->at,
            ray.origin + met->at * ray.direction,
            (posed[j] - posed[i]).cross(posed[k] - posed[i]).normalized()};
  }
  return best;
}

/// Two dancers, the second beside the first.
struct Pair {
  Dancer dancer;
  std::array<LiveBody, 2> body;
  std::array<std::span<const LivePart>, 2> bodies;

  explicit Pair(std::mt19937_64& random) : body{bodyOf(dancer), bodyOf(dancer)} {
    move(random, 0, Vec3(0.0, 0.95, 0.0));
    move(random, 1, Vec3(0.5, 0.95, 0.3));
    bodies = {body[0].parts(), body[1].parts()};
  }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;

  static LiveBody bodyOf(const Dancer& dancer) {
    return LiveBody::create(dancer.decomposition, dancer.character).value();
  }
  /// Another pose, with the hips at a point.
  void move(std::mt19937_64& random, std::size_t which, const Vec3& hips) {
    dancer.dance(random, 0.6);
    const Vec3 by = hips - dancer.worldFromModel[0] * Vec3(0.0, 0.95, 0.0);
    for (Affine3& bone : dancer.worldFromModel) bone.pretranslate(by);
    body[which].update(dancer.worldFromModel);
  }
};

/// From around the dancers, or from within, at a point of them.
HullRay randomRay(std::mt19937_64& random) {
  HullRay ray;
  const bool within = uniform(random, 0.0, 1.0) < 0.2;
  ray.origin = uniformVec3(random, -1.0, 1.0).cwiseProduct(within ? Vec3(0.5, 0.9, 0.2) : Vec3(4.0, 3.0, 4.0)) +
               Vec3(0.2, 0.9, 0.1);
  const Vec3 target = uniformVec3(random, -1.0, 1.0).cwiseProduct(Vec3(0.8, 0.9, 0.5)) + Vec3(0.2, 0.9, 0.1);
  ray.direction = (target - ray.origin).normalized();
  if (uniform(random, 0.0, 1.0) < 0.3) ray.reach = uniform(random, 0.0, 5.0);
  return ray;
}

TEST(RayQuery, AnswersLikeEveryTriangleAsked) {
  std::mt19937_64 random(48);
  int hits = 0, insides = 0, grazing = 0, nextTo = 0;
  constexpr int kPoses = 5, kRays = 4000;  // a million by bench/rays --check
  for (int pose = 0; pose < kPoses; ++pose) {
    const Pair pair(random);
    RayQuery query;
    query.update(pair.bodies);
    const std::array hulls{slowHulls(pair.bodies[0]), slowHulls(pair.bodies[1])};
    for (int i = 0; i < kRays; ++i) {
      const HullRay ray = randomRay(random);
      const HullHit fast = query.nearest(ray), slow = slowNearest(hulls, ray);
      const Agreement agreement = compare(hulls, ray, fast, slow);
      ASSERT_NE(agreement, Agreement::kDifferent) << i;
      grazing += agreement == Agreement::kGrazing ? 1 : 0;
      hits += slow ? 1 : 0;
      insides += slow && slow.distance == 0.0 ? 1 : 0;
      if (!slow || agreement == Agreement::kGrazing) continue;
      // On an edge of two faces, or where two parts touch, either is right.
      if (fast.part != slow.part || fast.body != slow.body || (fast.normal - slow.normal).norm() > 1e-6) ++nextTo;
      EXPECT_LT((fast.position - slow.position).norm(), 1e-9);
      EXPECT_NEAR(fast.normal.norm(), 1.0, 1e-12);
    }
  }
  EXPECT_GT(hits, kPoses * kRays / 5);
  EXPECT_GT(insides, 100);
  EXPECT_LE(grazing, 2);
  EXPECT_LE(nextTo, kPoses * kRays / 200);
}

TEST(RayQuery, SkinIsMetWhereEveryTriangleAskedSays) {
  std::mt19937_64 random(51);
  Pair pair(random);
  const std::span<const Triangle> triangles = pair.dancer.character.mesh.triangles;
  std::vector<PosedSkin> skins(2, PosedSkin(pair.dancer.decomposition, pair.dancer.character));
  RayQuery query;
  EXPECT_FALSE(query.nearestOnSkin({}, {})) << "before any body";
  int hits = 0, within = 0, hullsOnly = 0, grazing = 0;
  for (int pose = 0; pose < 4; ++pose) {
    std::array<std::vector<Vec3>, 2> posed;
    for (std::size_t b = 0; b < 2; ++b) {
      pair.move(random, b, b == 0 ? Vec3(0.0, 0.95, 0.0) : Vec3(0.5, 0.95, 0.3));
      posed[b].resize(pair.dancer.character.mesh.vertices.size());
      skinLinearBlend(pair.dancer.character, pair.dancer.worldFromModel, posed[b]);
      skins[b].update(pair.dancer.worldFromModel);
    }
    query.update(pair.bodies);
    for (int i = 0; i < 250; ++i) {
      const HullRay ray = randomRay(random);
      SkinHit slow;
      for (int b = 0; b < 2; ++b) {
        const SkinHit hit = slowNearestOnSkin(posed[b], triangles, ray);
        if (!hit || hit.distance >= slow.distance) continue;
        slow = hit;
        slow.body = b;
      }
      const long before = allocationCount();
      const SkinHit fast = query.nearestOnSkin(ray, skins);
      EXPECT_EQ(allocationCount(), before);
      const HullHit hull = query.nearest(ray);
      hullsOnly += hull && !fast ? 1 : 0;
      if (fast.triangle != slow.triangle && std::abs(fast.distance - slow.distance) > 1e-9) {
        ++grazing;  // along the rim of a hull
        continue;
      }
      if (!slow) continue;
      ++hits;
      within += hull.distance == 0.0 ? 1 : 0;
      EXPECT_EQ(fast.body, slow.body);
      EXPECT_NEAR(fast.distance, slow.distance, 1e-9);
      EXPECT_GE(fast.distance, hull.distance - 1e-6);
      EXPECT_LT((fast.normal - slow.normal).norm(), 1e-9);
      EXPECT_NEAR(fast.weights.sum(), 1.0, 1e-12);
      EXPECT_GE(fast.weights.minCoeff(), 0.0);
      Vec3 there = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k) there += fast.weights[k] * posed[fast.body][triangles[fast.triangle][k]];
      EXPECT_LT((there - fast.position).norm(), 1e-9);
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(within, 20);
  EXPECT_GT(hullsOnly, 20);
  EXPECT_EQ(grazing, 0);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(query.nearestOnSkin({Vec3(0.0, kNan, 0.0), Vec3::UnitX()}, skins));
  EXPECT_FALSE(query.nearestOnSkin({Vec3::Zero(), Vec3::Zero()}, skins));
}

TEST(RayQuery, GivesTheSameBitsOnEveryInstructionSetForOneOrMany) {
  std::mt19937_64 random(5);
  const Pair pair(random);
  RayQuery query;
  query.update(pair.bodies);
  std::vector<HullRay> rays(500);
  for (HullRay& ray : rays) ray = randomRay(random);
  std::vector<HullHit> expected;
  for (const HullRay& ray : rays) expected.push_back(query.nearest(ray));
  onEveryInstructionSet([&] {
    std::vector<HullHit> hits(rays.size());
    query.nearest(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(hits[i].body, expected[i].body);
      EXPECT_EQ(hits[i].part, expected[i].part);
      EXPECT_EQ(hits[i].distance, expected[i].distance);
      EXPECT_EQ(hits[i].normal, expected[i].normal);
    }
  });
}

TEST(RayQuery, AllHitsAreOneForEachPartNearestFirst) {
  std::mt19937_64 random(6);
  const Pair pair(random);
  RayQuery query;
  query.update(pair.bodies);
  std::size_t most = 0;
  for (int i = 0; i < 500; ++i) {
    const HullRay ray = randomRay(random);
    std::vector<HullHit> hits(64);
    hits.resize(query.all(ray, hits));
    most = std::max(most, hits.size());
    EXPECT_EQ(hits.empty(), !query.nearest(ray));
    if (!hits.empty()) {
      EXPECT_EQ(hits[0].distance, query.nearest(ray).distance);
    }
    EXPECT_TRUE(std::ranges::is_sorted(hits, {}, &HullHit::distance));
    for (std::size_t k = 0; k < hits.size(); ++k) {
      for (std::size_t other = 0; other < k; ++other) {
        EXPECT_FALSE(hits[k].body == hits[other].body && hits[k].part == hits[other].part);
      }
    }
    // With less room the nearest ones remain.
    std::array<HullHit, 2> two;
    EXPECT_EQ(query.all(ray, two), hits.size());
    for (std::size_t k = 0; k < std::min<std::size_t>(2, hits.size()); ++k) {
      EXPECT_EQ(two[k].distance, hits[k].distance);
    }
    EXPECT_EQ(query.all(ray, {}), hits.size());
  }
  EXPECT_GE(most, 4u);
}

TEST(RayQuery, LengthsAndEndsOfRays) {
  std::mt19937_64 random(7);
  const Pair pair(random);
  RayQuery query;
  query.update({pair.bodies.data(), 1});
  HullRay ray{pair.body[0].parts()[0].worldFromPart * Vec3(0.0, 0.0, 3.0)};
  ray.direction = (pair.body[0].parts()[0].worldFromPart.translation() - ray.origin).normalized();
  const HullHit hit = query.nearest(ray);
  ASSERT_TRUE(hit);
  EXPECT_NEAR((hit.position - ray.origin).norm(), hit.distance, 1e-12);
  ray.direction *= 1e-3;
  EXPECT_NEAR(query.nearest(ray).distance, hit.distance, 1e-12) << "distances are metres, not lengths of the direction";
  ray.reach = hit.distance + 1e-9;
  EXPECT_TRUE(query.nearest(ray));
  ray.reach = hit.distance - 1e-9;
  EXPECT_FALSE(query.nearest(ray));
  ray.reach = kInfinity;
  ray.direction = -ray.direction;
  EXPECT_FALSE(query.nearest(ray)) << "behind";
}

TEST(RayQuery, WhatIsNoRayHitsNothing) {
  std::mt19937_64 random(8);
  const Pair pair(random);
  RayQuery query;
  EXPECT_FALSE(query.nearest({Vec3::Zero(), Vec3::UnitX()})) << "before any body";
  query.update(pair.bodies);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Vec3 from(0.0, 1.0, 3.0), towards = (pair.body[0].parts()[0].worldFromPart.translation() - from).normalized();
  ASSERT_TRUE(query.nearest({from, towards}));
  for (const HullRay& ray :
       {HullRay{from, Vec3::Zero()}, HullRay{from, Vec3(kNan, 0.0, 0.0)}, HullRay{Vec3(0.0, kNan, 0.0), towards},
        HullRay{from, Vec3(kInfinity, 0.0, 0.0)}, HullRay{Vec3(kInfinity, 0.0, 0.0), towards},
        HullRay{from, towards, -1.0}, HullRay{from, towards, kNan}, HullRay{Vec3::Constant(1e300), towards},
        HullRay{from, towards, 9.0, -0.1}, HullRay{from, towards, 9.0, kNan}, HullRay{from, towards, 9.0, kInfinity},
        HullRay{from, towards, 9.0, 0.1, Vec3(0.0, kNan, 0.0)}}) {
    EXPECT_FALSE(query.nearest(ray));
    EXPECT_EQ(query.all(ray, {}), 0u);
  }
  query.update({});
  EXPECT_FALSE(query.nearest({from, towards}));
}

/// The point of a triangle that is nearest to a point: the foot of the perpendicular, or the nearest of its edges.
double slowDistance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a).normalized();
  const auto beside = [&](const Vec3& from, const Vec3& to) { return (to - from).cross(p - from).dot(normal) < 0.0; };
  if (!beside(a, b) && !beside(b, c) && !beside(c, a)) return std::abs((p - a).dot(normal));
  double least = kInfinity;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const Vec3 along = to - from;
    const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (from + t * along - p).norm());
  }
  return least;
}

/// Of a point from a hull, 0 inside.
double slowDistance(const Vec3& p, const ConvexHull& hull) {
  double least = kInfinity;
  bool inside = true;
  for (const Triangle& triangle : hull.triangles) {
    const Vec3 &a = hull.vertices[triangle[0]], &b = hull.vertices[triangle[1]], &c = hull.vertices[triangle[2]];
    inside = inside && (p - a).dot((b - a).cross(c - a)) <= 0.0;
    least = std::min(least, slowDistance(p, a, b, c));
  }
  return inside ? 0.0 : least;
}

/// The least of a convex function between two places, and where it is.
template <typename Function>
std::pair<double, double> leastOf(double from, double to, const Function& f) {
  while (to - from > 1e-9) {
    const double a = from + (to - from) / 3.0, b = to - (to - from) / 3.0;
    (f(a) < f(b) ? to : from) = f(a) < f(b) ? b : a;
  }
  const double at = 0.5 * (from + to);
  return {at, f(at)};
}

/// When a ball or capsule first touches a hull: a ball touches the hull of all places where the capsule's axis would be
/// in it. The distance is a convex function of the way.
double slowTouch(const HullRay& ray, const ConvexHull& hull) {
  std::vector<Vec3> places;
  for (const Vec3& vertex : hull.vertices) places.insert(places.end(), {vertex + ray.half, vertex - ray.half});
  const ConvexHull sum = convexHull(places);
  const auto gap = [&](double at) { return slowDistance(ray.origin + at * ray.direction, sum) - ray.radius; };
  if (gap(0.0) <= 0.0) return 0.0;
  double outside = 0.0;
  const auto [at, least] = leastOf(0.0, std::min(ray.reach, 20.0), gap);
  double touching = at;
  if (least > 0.0) return kInfinity;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (outside + touching);
    (gap(middle) <= 0.0 ? touching : outside) = middle;
  }
  return touching;
}

TEST(RayQuery, BallsAndCapsulesTouchWhereTheirDistanceIsTheirRadius) {
  std::mt19937_64 random(49);
  int touched = 0, insides = 0, missed = 0;
  Pair pair(random);
  for (int i = 0; i < 300; ++i) {
    if (i % 100 == 0) pair.move(random, 0, Vec3(0.0, 0.95, 0.0));
    RayQuery query;
    const std::size_t part = i % pair.bodies[0].size();
    const std::span<const LivePart> one = pair.body[0].parts().subspan(part, 1);
    query.update(std::array{one});
    HullRay ray = randomRay(random);
    if (i % 4 != 0) ray.direction = (one[0].worldFromPart.translation() - ray.origin).normalized();
    ray.radius = uniform(random, 0.0, 0.3);
    if (i % 3 == 1) ray.half = uniformVec3(random, -0.4, 0.4);
    if (i % 9 == 1) ray.radius = 0.0;  // a stick
    const double slow = one[0].shape.degenerate() ? kInfinity : slowTouch(ray, worldHull(one[0]));
    const HullHit hit = query.nearest(ray);
    ASSERT_EQ(static_cast<bool>(hit), slow < kInfinity) << i;
    (hit ? hit.distance == 0.0 ? insides : touched : missed) += 1;
    if (!hit) continue;
    EXPECT_NEAR(hit.distance, slow, 1e-5) << i;
    if (hit.distance == 0.0) {
      EXPECT_LT((hit.normal + ray.direction).norm(), 1e-12);
      continue;
    }
    // It touches there, from outside.
    EXPECT_LT(slowDistance(hit.position, worldHull(one[0])), 1e-8);
    const Vec3 middle = ray.origin + hit.distance * ray.direction - hit.position;
    const double s = leastOf(-1.0, 1.0, [&](double t) { return (middle + t * ray.half).norm(); }).first;
    if (ray.radius > 0.0) {
      EXPECT_NEAR((middle + s * ray.half).norm(), ray.radius, 1e-6);
      EXPECT_LT(((middle + s * ray.half).normalized() - hit.normal).norm(), 1e-4);
    }
    EXPECT_LE(hit.normal.dot(ray.direction), 1e-9);
  }
  EXPECT_GT(touched, 25);
  EXPECT_GT(insides, 3);
  EXPECT_GT(missed, 25);
}

TEST(RayQuery, TheNearestOfAllIsTouchedFirst) {
  std::mt19937_64 random(50);
  const Pair pair(random);
  RayQuery query;
  query.update(pair.bodies);
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    HullRay ray = randomRay(random);
    ray.radius = 0.1;
    ray.half = uniformVec3(random, -0.2, 0.2);
    double slow = kInfinity;
    for (const LiveBody& body : pair.body) {
      for (const LivePart& part : body.parts()) {
        RayQuery alone;
        const std::span<const LivePart> one(&part, 1);
        alone.update(std::array{one});
        const HullHit hit = alone.nearest(ray);
        if (hit) slow = std::min(slow, hit.distance);
      }
    }
    const HullHit hit = query.nearest(ray);
    EXPECT_EQ(hit ? hit.distance : kInfinity, slow);
    hits += hit ? 1 : 0;
    // A ball that is hardly one is a ray.
    HullRay thin = randomRay(random), thick = thin;
    thick.radius = 1e-7;
    const HullHit a = query.nearest(thin), b = query.nearest(thick);
    if (a && b) {
      EXPECT_NEAR(a.distance, b.distance, 1e-4);
    }
  }
  EXPECT_GT(hits, 40);
}

TEST(RayQuery, FramesAndRaysAllocateNothing) {
  std::mt19937_64 random(9);
  Pair pair(random);
  RayQuery query;
  for (int frame = 0; frame < 20; ++frame) {
    pair.move(random, 0, Vec3(0.0, 0.95, 0.0));
    const long before = allocationCount();
    query.update(pair.bodies);
    std::array<HullHit, 8> hits;
    for (int i = 0; i < 50; ++i) {
      HullRay ray = randomRay(random);
      (void)query.all(ray, hits);
      ray.radius = 0.1;
      (void)query.all(ray, hits);
    }
    if (frame == 0) continue;
    EXPECT_EQ(allocationCount() - before, 0) << frame;
  }
}

}  // namespace
}  // namespace lorica::test
