#include "collision/live/ray_query.h"

#include "collision/live/clip_kernel.h"
#include "collision/live/hull_distance.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lorica {
namespace {

constexpr double kBallMargin = 1e-9;  ///< [m] for rounding: a face that touches its ball is not lost
constexpr double kTouching = 1e-9;    ///< of what is swept [m]
constexpr double kNormalFrom = 1e-6;  ///< a shorter way to the hull has no direction to speak of [m]
constexpr int kMaxAdvances = 64;

std::size_t padded(std::size_t count) {
  return (count + kClipPadding - 1) / kClipPadding * kClipPadding;
}

/// The planes of a hull's faces, one array a coordinate; the padding holds everything.
void writePlanes(const ConvexHull& hull, std::span<double> planes) {
  const std::size_t count = planes.size() / 4;
  std::fill(planes.begin(), planes.end() - static_cast<std::ptrdiff_t>(count), 0.0);
  std::fill(planes.end() - static_cast<std::ptrdiff_t>(count), planes.end(), 1.0);
  for (std::size_t f = 0; f < hull.triangles.size(); ++f) {
    const Vec3 normal = areaNormal(hull.vertices, hull.triangles[f]);
    for (std::size_t axis = 0; axis < 3; ++axis) planes[axis * count + f] = normal[axis];
    planes[3 * count + f] = normal.dot(hull.vertices[hull.triangles[f][0]]);
  }
}

/// Shortens a ray to a box (Kay and Kajiya 1986); false if it misses. What is no number, 0 * infinity, limits nothing.
bool clip(const Aabb& box, const Vec3& origin, const Vec3& direction, double& from, double& to) {
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1.0 / direction[axis];
    const double a = (box.min[axis] - origin[axis]) * inverse, b = (box.max[axis] - origin[axis]) * inverse;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

/// Where something swept touches a hull, all in the hull's frame; the distance is infinite if it never does.
struct Touching {
  double distance = kInfinity;
  Vec3 position, normal;
};
Touching sweptTo(std::span<const Vec3> vertices, const Vec3& origin, const Vec3& direction, const Vec3& half,
                 double radius, double reach) {
  double at = 0.0;
  Vec3 normal = Vec3::Zero();  // as seen from far enough
  for (int step = 0; step < kMaxAdvances; ++step) {
    const HullGap gap = gapOf(vertices, origin + at * direction, half);
    const double left = gap.distance - radius;
    if (gap.distance > kNormalFrom || normal.isZero()) normal = gap.normal;
    if (left <= kTouching) return {at, gap.onHull, normal};
    // The distance from a convex hull falls ever more slowly: no step goes too far.
    const double speed = -gap.normal.dot(direction);
    if (speed <= 0.0) return {};
    at += left / speed;
    if (!(at <= reach)) return {};
  }
  return {};
}

}  // namespace

void RayQuery::update(std::span<const std::span<const LivePart>> bodies) {
  parts_.clear();
  firstPart_.clear();
  // Hulls have room for the most faces that they can get.
  std::size_t mostParts = 0, mostPlanes = 0, mostVertices = 0, planes = 0;
  for (const std::span<const LivePart> parts : bodies) {
    mostParts += padded(parts.size());
    for (const LivePart& part : parts) {
      mostPlanes += 4 * padded(part.shape.triangles.capacity());
      mostVertices += part.shape.vertices.capacity();
    }
  }
  parts_.reserve(mostParts);
  planes_.reserve(mostPlanes);
  vertices_.clear();
  vertices_.reserve(mostVertices);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    firstPart_.push_back(parts_.size());
    const std::span<const LivePart> parts = bodies[b];
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (parts[p].shape.degenerate()) continue;
      const std::size_t count = padded(parts[p].shape.triangles.size());
      const std::vector<Vec3>& vertices = parts[p].shape.vertices;
      parts_.push_back({parts[p].worldFromPart.inverse(), planes, count, vertices_.size(), vertices.size(),
                        static_cast<int>(b), static_cast<PartIndex>(p)});
      Aabb& box = parts_.back().box;
      for (const Vec3& vertex : vertices) box.extend(vertex);
      box.min.array() -= kBallMargin;
      box.max.array() += kBallMargin;
      vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
      planes += 4 * count;
    }
    parts_.resize(padded(parts_.size()));
  }
  firstPart_.push_back(parts_.size());
  planes_.resize(planes);
  partBalls_.resize(mostParts);
  bodyBalls_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Aabb box;
    for (std::size_t i = firstPart_[b]; i < firstPart_[b + 1]; ++i) {
      const Part& part = parts_[i];
      if (part.planeCount == 0) continue;
      const LivePart& live = bodies[b][part.index];
      writePlanes(live.shape, std::span(planes_).subspan(part.firstPlane, 4 * part.planeCount));
      const Vec3 middle = live.worldFromPart.translation();
      partBalls_.set(i, middle, live.radius + kBallMargin);
      box.extend(middle);
    }
    if (box.empty()) continue;
    const Vec3 middle = 0.5 * (box.min + box.max);
    double radius = 0.0;
    for (std::size_t i = firstPart_[b]; i < firstPart_[b + 1]; ++i) {
      if (parts_[i].planeCount == 0) continue;
      radius = std::max(radius, (partBalls_.middle(i) - middle).norm() + partBalls_.radius[i]);
    }
    bodyBalls_.set(b, middle, radius + kBallMargin);
  }
}

/// Calls `each` with hits in any order; it returns the distance beyond which nothing counts any more.
template <typename Visit>
void RayQuery::visit(const HullRay& ray, const Visit& each) const {
  const double length = ray.direction.norm();
  if (!(length > 0.0) || !std::isfinite(length) || !ray.origin.allFinite() || !(ray.reach >= 0.0)) return;
  const double thickness = ray.radius + ray.half.norm();
  if (!(ray.radius >= 0.0) || !std::isfinite(thickness)) return;
  const Vec3 direction = ray.direction / length;
  double reach = ray.reach;
  const auto visitPart = [&](const Part& part) {
    const Vec3 origin = part.partFromWorld * ray.origin, along = part.partFromWorld.linear() * direction;
    if (ray.swept()) {
      const Touching touching = sweptTo(std::span(vertices_).subspan(part.firstVertex, part.vertexCount), origin, along,
                                        part.partFromWorld.linear() * ray.half, ray.radius, reach);
      if (touching.distance == kInfinity) return;
      if (touching.distance == 0.0) {
        reach = std::min(reach, each(HullHit{part.body, part.index, 0.0, ray.origin, -direction}));
        return;
      }
      const auto worldFromPart = part.partFromWorld.linear().transpose();
      const Vec3 position = worldFromPart * (touching.position - part.partFromWorld.translation());
      reach = std::min(
          reach, each(HullHit{part.body, part.index, touching.distance, position, worldFromPart * touching.normal}));
      return;
    }
    double from = 0.0, to = reach;
    if (!clip(part.box, origin, along, from, to)) return;
    const std::span<const double> planes = std::span(planes_).subspan(part.firstPlane, 4 * part.planeCount);
    const Entry entry = entryOf(planes, origin, along, from, to);
    if (entry.at == kInfinity) return;
    HullHit hit{part.body, part.index, entry.at, ray.origin + entry.at * direction, -direction};
    if (entry.plane >= 0) {
      const std::size_t f = entry.plane;
      const Vec3 normal(planes[f], planes[part.planeCount + f], planes[2 * part.planeCount + f]);
      hit.normal = part.partFromWorld.linear().transpose() * normal.normalized();
    }
    reach = std::min(reach, each(hit));
  };
  const auto visitNear = [&](const BallList& list, std::size_t from, std::size_t to, const auto& act) {
    const Balls balls{list.x, list.y, list.z, list.radius};
    for (std::size_t first = from; first < to; first += kMostBalls) {
      const std::size_t count = std::min(kMostBalls, to - first);
      for (std::uint64_t near = ballsOnRay(balls, first, count, ray.origin, direction, reach, thickness); near != 0;
           near &= near - 1) {
        act(first + static_cast<std::size_t>(std::countr_zero(near)));
      }
    }
  };
  visitNear(bodyBalls_, 0, bodyBalls_.x.size(), [&](std::size_t body) {
    visitNear(partBalls_, firstPart_[body], firstPart_[body + 1], [&](std::size_t i) { visitPart(parts_[i]); });
  });
}

HullHit RayQuery::nearest(const HullRay& ray) const {
  HullHit best;
  visit(ray, [&](const HullHit& hit) {
    // Of several at the same distance the first part, in whatever order they are asked.
    if (!best || hit.distance < best.distance) best = hit;
    return best.distance;
  });
  return best;
}

void RayQuery::nearest(std::span<const HullRay> rays, std::span<HullHit> hits) const {
  LORICA_CHECK(rays.size() == hits.size(), "there must be as many hits as rays");
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = nearest(rays[i]);
}

SkinHit RayQuery::nearestOnSkin(const HullRay& ray, std::span<PosedSkin> skins) const {
  LORICA_CHECK(skins.size() + 1 >= firstPart_.size(), "there must be a skin for each body");
  SkinHit best;
  best.distance = ray.reach;
  const Vec3 direction = ray.direction.normalized();
  visit({ray.origin, ray.direction, ray.reach}, [&](const HullHit& hull) {
    const double before = best.distance;
    skins[hull.body].meet(hull.part, ray.origin, direction, best);
    if (best.distance < before) best.body = hull.body;
    return best.distance;
  });
  return best ? best : SkinHit();
}

std::size_t RayQuery::all(const HullRay& ray, std::span<HullHit> hits) const {
  std::size_t found = 0, kept = 0;
  visit(ray, [&](const HullHit& hit) {
    ++found;
    std::size_t at = kept;
    while (at > 0 && hits[at - 1].distance > hit.distance) --at;
    if (at == hits.size()) return kInfinity;
    kept = std::min(kept + 1, hits.size());
    std::shift_right(hits.begin() + static_cast<std::ptrdiff_t>(at), hits.begin() + static_cast<std::ptrdiff_t>(kept),
                     1);
    hits[at] = hit;
    return kInfinity;
  });
  return found;
}

}  // namespace lorica
