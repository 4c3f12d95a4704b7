#include "tests/collision/live/slow_rays.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lorica::test {
namespace {

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

}  // namespace

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

}  // namespace lorica::test
