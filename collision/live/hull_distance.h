#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// A ball (half is zero), capsule or hull beside a hull. Internal.
struct HullGap {
  double distance = 0.0;       ///< between the hull and the capsule's axis, or the other hull; 0 = they meet
  Vec3 onHull = Vec3::Zero();  ///< nearest point of the hull
  Vec3 normal = Vec3::Zero();  ///< from there to the axis or the other hull, unit; zero if they meet
};

/// The distance of a point, or of a segment, from the hull of some vertices: the algorithm of Gilbert, Johnson and
/// Keerthi (1988) in double precision.
/// @param vertices  at least one
/// @param middle    of the segment
/// @param half      from there to its end
[[nodiscard]] HullGap gapOf(std::span<const Vec3> vertices, const Vec3& middle, const Vec3& half);

/// The same for two hulls. Of hulls that meet the distance may be a rounding error above 0, with any normal.
/// @param others  vertices of the second, at least one, in the same frame
[[nodiscard]] HullGap gapOf(std::span<const Vec3> vertices, std::span<const Vec3> others);

}  // namespace lorica
