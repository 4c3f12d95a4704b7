#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// Mean of points; zero for none [m].
[[nodiscard]] Vec3 centroidOf(std::span<const Vec3> points);

/// The rotation and translation, no mirror and no scale, that bring `from` closest to `to` in the sum of squared
/// distances (Kabsch 1976). Flat sets have one answer. Where points leave rotation open (all on a line, or all in one
/// place), it is the one nearest to `previous`, so the motion of a body does not jump from frame to frame.
/// @param from      points about their own centroid: their mean must be zero [m]
/// @param to        where each of them is now, same count, at least one [m]
/// @param previous  rotation to stay near
[[nodiscard]] Isometry3 fitRigidMotion(std::span<const Vec3> from, std::span<const Vec3> to, const Mat3& previous);

}  // namespace lorica
