#include "collision/particle_push_exit.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace lorica {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A plane of a hull.
struct Side {
  std::size_t hull = 0;
  std::size_t plane = 0;
};

bool outsideBox(const PushHulls::Hull& hull, const Vec3f& p) {
  return (p.array() < hull.boxMin.array()).any() || (p.array() > hull.boxMax.array()).any();
}

/// The hull that a point is deepest inside of, and its nearest plane; none where it is inside of none.
std::optional<Side> deepest(const PushHulls& hulls, const Vec3f& p) {
  std::optional<Side> side;
  float lowest = 0.0F;
  for (std::size_t h = 0; h < hulls.hulls().size(); ++h) {
    const PushHulls::Hull& hull = hulls.hulls()[h];
    if (outsideBox(hull, p)) continue;
    const PushHulls::Nearest nearest = hulls.nearest(hull, p);
    if (nearest.height >= lowest) continue;
    lowest = nearest.height;
    side = Side{h, nearest.plane};
  }
  return side;
}

/// The point nearest to `start` that is a margin above all of up to three planes; none where they are too parallel.
std::optional<Vec3f> ontoAll(const PushHulls& hulls, const Vec3f& start, std::span<const Side> sides) {
  const double above = static_cast<double>(hulls.margin());
  std::array<Vec3, 3> normals;
  Vec3 lift;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    normals[i] = hulls.normal(sides[i].plane).cast<double>();
    lift[static_cast<Eigen::Index>(i)] = above - static_cast<double>(hulls.height(sides[i].plane, start));
  }
  const Vec3 from = start.cast<double>();
  if (sides.size() == 1) return (from + lift[0] * normals[0]).cast<float>();
  if (sides.size() == 2) {
    const double cosine = normals[0].dot(normals[1]);
    const double sineSq = 1.0 - cosine * cosine;
    if (sineSq < 1e-3) return {};
    const Vec3 moved =
        ((lift[0] - cosine * lift[1]) / sineSq) * normals[0] + ((lift[1] - cosine * lift[0]) / sineSq) * normals[1];
    return (from + moved).cast<float>();
  }
  const double determinant = normals[0].dot(normals[1].cross(normals[2]));
  if (std::abs(determinant) < 1e-2) return {};
  const Vec3 moved = (lift[0] * normals[1].cross(normals[2]) + lift[1] * normals[2].cross(normals[0]) +
                      lift[2] * normals[0].cross(normals[1])) /
                     determinant;
  return (from + moved).cast<float>();
}

/// How far to go from `start` along a direction until outside of all hulls, and through which plane. A ray leaves each
/// convex hull once, so that this comes to an end.
struct Way {
  float length = kInfinity;
  Side side;
};

Way leaveAlong(const PushHulls& hulls, const Vec3f& start, const Vec3f& direction, Side side) {
  Way way{0.0F, side};
  const std::size_t rounds = hulls.hulls().size() + 1;
  for (std::size_t round = 0; round < rounds; ++round) {
    const Vec3f here = start + way.length * direction;
    const std::optional<Side> inside = deepest(hulls, here);
    if (!inside) return way;
    const PushHulls::Hull& hull = hulls.hulls()[inside->hull];
    float length = kInfinity;
    for (std::size_t i = hull.firstPlane; i < hull.firstPlane + hull.planeCount; ++i) {
      const float rise = hulls.normal(i).dot(direction);
      if (rise < 1e-3F) continue;
      const float there = way.length + (hulls.margin() - hulls.height(i, here)) / rise;
      if (there >= length) continue;
      length = there;
      way.side = {inside->hull, i};
    }
    if (!(length < kInfinity)) break;
    way.length = length;
  }
  return {};
}

}  // namespace

PushExit findExit(const PushHulls& hulls, const Vec3f& start, std::size_t hull, std::size_t plane) {
  // Out of one hull, and where that leads into others, into the crease between them.
  std::array<Side, 3> sides = {Side{hull, plane}};
  std::size_t count = 1;
  const float first = hulls.margin() - hulls.height(plane, start);
  std::optional<PushExit> found;
  float length = kInfinity;
  while (true) {
    const std::optional<Vec3f> place = ontoAll(hulls, start, std::span(sides).first(count));
    if (!place) break;
    const std::optional<Side> next = deepest(hulls, *place);
    if (!next) {
      length = (*place - start).norm();
      found = PushExit{*place, sides[count - 1].hull, sides[count - 1].plane};
      break;
    }
    if (count == sides.size()) break;
    sides[count++] = *next;
  }
  if (found && length <= 3.0F * first) return *found;

  // Straight along the nearest way out of any hull that holds the start.
  for (std::size_t h = 0; h < hulls.hulls().size(); ++h) {
    if (outsideBox(hulls.hulls()[h], start)) continue;
    const PushHulls::Nearest nearest = hulls.nearest(hulls.hulls()[h], start);
    if (nearest.height >= 0.0F) continue;
    const Vec3f direction = hulls.normal(nearest.plane);
    const Way way = leaveAlong(hulls, start, direction, {h, nearest.plane});
    if (way.length >= length) continue;
    length = way.length;
    found = PushExit{start + way.length * direction, way.side.hull, way.side.plane};
  }
  return found ? *found : PushExit{start, hull, plane};
}

}  // namespace lorica
