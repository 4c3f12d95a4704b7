#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// Mean of points; zero for none [m].
[[nodiscard]] Vec3 centroidOf(std::span<const Vec3> points);

/// The rotation R, no mirror and no scale, with the largest trace(R^T covariance): the one that fits best where the
/// covariance is a sum of (where a point is) x (where it was, about the mean)^T. Where points leave rotation open (all
/// on a line, or all in one place), it is the one nearest to `previous`. 2 us for what is nearly flat.
[[nodiscard]] Mat3 fitRotation(const Mat3& covariance, const Mat3& previous);

/// The same for several, which is quicker: about 0.05 us each, where the rotations change little from frame to frame.
/// @param rotations  in: previous ones; out: the fits
void fitRotations(std::span<const Mat3> covariances, std::span<Mat3> rotations);

/// The rotation and translation, no mirror and no scale, that bring `from` closest to `to` in the sum of squared
/// distances (Kabsch 1976). Flat sets have one answer. Where points leave rotation open (all on a line, or all in one
/// place), it is the one nearest to `previous`, so the motion of a body does not jump from frame to frame.
/// @param from      points about their own centroid: their mean must be zero [m]
/// @param to        where each of them is now, same count, at least one [m]
/// @param previous  rotation to stay near
[[nodiscard]] Isometry3 fitRigidMotion(std::span<const Vec3> from, std::span<const Vec3> to, const Mat3& previous);

}  // namespace lorica
