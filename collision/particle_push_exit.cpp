#include "collision/particle_push_exit.h"

#include <algorithm>
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

/// The hulls, and where they are.
struct Union {
  const PushHulls& hulls;
  const PushGrid& grid;

  /// The side through which a point is deepest inside; none where it is outside.
  [[nodiscard]] std::optional<Side> deepest(const Vec3f& p) const {
    const PushDepth depth = deepestAt(hulls, grid, p);
    return depth.height < 0.0F ? std::optional<Side>({depth.hull, depth.plane}) : std::nullopt;
  }
};

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

/// Planes that are met on the way, at most; and which of the older ones are tried together with the newest.
constexpr std::size_t kMostSides = 4;
constexpr std::array<std::array<std::size_t, 3>, 7> kSubsets = {
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 0, 1}, {2, 0, 2}, {2, 1, 2}}};

/// Whether a point that is on these planes is where they are faces.
bool onSurfaces(const PushHulls& hulls, const Vec3f& p, std::span<const Side> sides) {
  return std::all_of(sides.begin(), sides.end(), [&](const Side& side) {
    return hulls.nearest(hulls.hulls()[side.hull], p).height < 8.0F * hulls.margin();
  });
}

/// How far to go from `start` along a direction until outside of all hulls, and through which plane. A ray leaves each
/// convex hull once, so that this comes to an end.
struct Way {
  float length = kInfinity;
  Side side;
};

Way leaveAlong(const Union& all, const Vec3f& start, const Vec3f& direction, Side side) {
  const PushHulls& hulls = all.hulls;
  Way way{0.0F, side};
  const std::size_t rounds = hulls.hulls().size() + 1;
  for (std::size_t round = 0; round < rounds; ++round) {
    const Vec3f here = start + way.length * direction;
    const std::optional<Side> inside = all.deepest(here);
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

/// Where else to try when all hints lead far.
const std::array<Vec3f, 14>& anyDirections() {
  static const std::array<Vec3f, 14> directions = [] {
    const float third = std::sqrt(1.0F / 3.0F);
    std::array<Vec3f, 14> made;
    for (std::size_t i = 0; i < 8; ++i) {
      made[i] = third * Vec3f((i & 1) != 0 ? 1.0F : -1.0F, (i & 2) != 0 ? 1.0F : -1.0F, (i & 4) != 0 ? 1.0F : -1.0F);
    }
    for (std::size_t i = 0; i < 6; ++i) {
      made[8 + i] = (i % 2 == 0 ? 1.0F : -1.0F) * Vec3f::Unit(static_cast<Eigen::Index>(i / 2));
    }
    return made;
  }();
  return directions;
}

}  // namespace

PushExit findExit(const PushHulls& hulls, const PushGrid& grid, const Vec3f& start, const PushDepth& inside) {
  const Union all{hulls, grid};
  // Out of one hull; where that leads into others, out of these, or into the crease between some of them.
  std::array<Side, kMostSides> sides = {Side{inside.hull, inside.plane}};
  std::size_t count = 1;
  const float first = hulls.margin() - inside.height;
  std::optional<PushExit> found;
  float length = kInfinity;
  while (!found) {
    std::optional<Side> next;
    for (const std::array<std::size_t, 3>& others : kSubsets) {
      std::array<Side, 3> used = {sides[count - 1]};
      std::size_t usedCount = 1;
      bool known = true;
      for (std::size_t i = 0; i < others[0]; ++i) {
        known = known && others[1 + i] + 1 < count;
        used[usedCount++] = sides[others[1 + i]];
      }
      if (!known) continue;
      const std::span<const Side> chosen = std::span(used).first(usedCount);
      const std::optional<Vec3f> place = ontoAll(hulls, start, chosen);
      if (!place) continue;
      const float distance = (*place - start).norm();
      if (distance >= length) continue;
      const std::optional<Side> met = all.deepest(*place);
      if (!met) {
        if (!onSurfaces(hulls, *place, chosen)) continue;
        length = distance;
        found = PushExit{*place, used[0].hull, used[0].plane};
      } else if (!next) {
        next = met;
      }
    }
    if (found || !next || count == kMostSides) break;
    sides[count++] = *next;
  }
  if (found && length <= 2.0F * first) return *found;

  // Straight along the normal of any plane met so far, or of the nearest way out of any hull that holds the start.
  const auto tryAlong = [&](const Vec3f& direction, const Side& side) {
    const Way way = leaveAlong(all, start, direction, side);
    if (way.length >= length) return;
    length = way.length;
    found = PushExit{start + way.length * direction, way.side.hull, way.side.plane};
  };
  for (std::size_t h = 0; h < hulls.hulls().size(); ++h) {
    if (outsideBox(hulls.hulls()[h], start)) continue;
    const PushHulls::Nearest nearest = hulls.nearest(hulls.hulls()[h], start);
    if (nearest.height < 0.0F) tryAlong(hulls.normal(nearest.plane), {h, nearest.plane});
  }
  for (std::size_t i = 1; i < count; ++i) tryAlong(hulls.normal(sides[i].plane), sides[i]);
  if (length > 2.0F * first) {
    for (const Vec3f& direction : anyDirections()) tryAlong(direction, sides[0]);
  }
  return found ? *found : PushExit{start, inside.hull, inside.plane};
}

}  // namespace lorica
