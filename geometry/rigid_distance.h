#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// Returns the distance between two poses of the same points after the best rigid alignment: the root mean square
/// distance of the points [m], rounded to a micrometre. Global position and orientation of the poses have no effect.
///
/// Computed from the largest eigenvalue of a 4 x 4 matrix (Horn 1987), without the rotation itself. Does not allocate.
/// @param a, b  equally many points, at least one, relative to their centroid [m]
[[nodiscard]] double rigidDistance(std::span<const Vec3> a, std::span<const Vec3> b);

}  // namespace lorica
