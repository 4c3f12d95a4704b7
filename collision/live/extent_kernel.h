#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// Bounds of points after a motion, with vector instructions; empty without points. Internal. The same on every
/// instruction set.
[[nodiscard]] Aabb boundsOf(std::span<const Vec3> points, const Isometry3& motion);
/// Greatest squared distance from the origin; 0 without points. Internal. The same on every instruction set.
[[nodiscard]] double farthestSq(std::span<const Vec3> points);
/// Begins to fetch points that will be read soon, at most 3 kB: hulls of a hundred avatars do not stay in the cache.
/// Internal.
void fetch(std::span<const Vec3> points);

}  // namespace lorica
