#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// How far two poses of the same points are apart once one was moved rigidly onto the other as well as it goes: root
/// mean square distance of the points [m], in steps of a micrometre. Where the poses stand and turn to does not count.
///
/// The best rotation is not needed, only what it gains: the largest eigenvalue of a 4 x 4 matrix (Horn 1987). Allocates
/// nothing.
/// @param a, b  the points of both, one or more, as many of each, about their centroid [m]
[[nodiscard]] double rigidDistance(std::span<const Vec3> a, std::span<const Vec3> b);

}  // namespace lorica
