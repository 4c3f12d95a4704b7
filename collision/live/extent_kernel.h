#pragma once

#include "geometry/math.h"

#include <cstddef>
#include <span>

namespace lorica {

/// Bounds of points after a motion, with vector instructions; empty without points. Internal. The same on every
/// instruction set.
[[nodiscard]] Aabb boundsOf(std::span<const Vec3> points, const Isometry3& motion);
/// Greatest squared distance from the origin; 0 without points. Internal. The same on every instruction set.
[[nodiscard]] double farthestSq(std::span<const Vec3> points);

/// Points for supportIndex() come in whole blocks; surplus entries of a block repeat one of the points.
inline constexpr int kSupportBlock = 16;

/// Index of the point farthest along a direction; of several, the first. The same on every machine: vector instructions
/// of any width compare identically rounded values.
/// @param x, y, z  coordinates of `count` points
/// @param count    above 0, a multiple of kSupportBlock
[[nodiscard]] int supportIndex(const float* x, const float* y, const float* z, int count, float directionX,
                               float directionY, float directionZ);

/// Begins to fetch what will be used soon, at most 3 kB: hulls of a hundred avatars do not stay in the cache. Internal.
void fetch(std::span<const std::byte> bytes);
inline void fetch(std::span<const Vec3> points) {
  fetch(std::as_bytes(points));
}

/// Whether two boxes are farther from each other than this along an axis.
[[nodiscard]] inline bool apart(const Aabb& a, const Aabb& b, double gap = 0.0) {
  return (a.min.array() > b.max.array() + gap).any() || (b.min.array() > a.max.array() + gap).any();
}

}  // namespace lorica
