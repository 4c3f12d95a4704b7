#pragma once

#include "geometry/math.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace lorica {

/// Counts of planes and balls are multiples of this, so that whole vectors suffice. Internal.
inline constexpr std::size_t kClipPadding = 8;

/// Where a ray comes into the intersection of some half-spaces, with vector instructions. Internal. The same on every
/// instruction set.
struct Entry {
  double at = kInfinity;    ///< in units of the direction; infinite if it never does
  std::int32_t plane = -1;  ///< through which, the first of several; -1 = it begins inside
};
/// @param planes  4 * count: normals' x, y, z, and offsets; count is a multiple of kClipPadding
/// @param from    0, or where the ray cannot have come in yet, in units of the direction
/// @param to      where the ray ends, or must have gone out
[[nodiscard]] Entry entryOf(std::span<const double> planes, const Vec3& origin, const Vec3& direction, double from,
                            double to);

/// Balls that a ray may hit before it ends.
struct Balls {
  std::span<const double> x, y, z, radius;  ///< multiples of kClipPadding
};
inline constexpr std::size_t kMostBalls = 64;
/// Whether each of some balls is within reach of a ray: one bit each.
/// @param count      from `first` on, a multiple of kClipPadding, at most kMostBalls
/// @param direction  unit
/// @param thickness  of the ray: how far it reaches aside [m]
[[nodiscard]] std::uint64_t ballsOnRay(const Balls& balls, std::size_t first, std::size_t count, const Vec3& origin,
                                       const Vec3& direction, double reach, double thickness);

}  // namespace lorica
