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
/// @param reach   where the ray ends, in units of the direction
[[nodiscard]] Entry entryOf(std::span<const double> planes, const Vec3& origin, const Vec3& direction, double reach);

/// Balls that a ray may hit before it ends.
struct Balls {
  std::span<const double> x, y, z, radius;  ///< multiples of kClipPadding
};
/// Whether each of the balls from `first` on, kClipPadding of them, is within reach of a ray: one bit each.
/// @param direction  unit
/// @param thickness  of the ray: how far it reaches aside [m]
[[nodiscard]] unsigned ballsOnRay(const Balls& balls, std::size_t first, const Vec3& origin, const Vec3& direction,
                                  double reach, double thickness);

}  // namespace lorica
