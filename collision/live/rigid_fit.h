#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// Mean of points; zero for none [m].
[[nodiscard]] Vec3 centroidOf(std::span<const Vec3> points);

/// The rotation R, without mirroring or scale, with the largest trace(R^T covariance). It is the best fit if the
/// covariance is a sum of (present position) x (earlier position about the mean)^T. If the points do not determine the
/// rotation (all on a line, or all in one position), it is the one nearest to `previous`. Takes 2 us for nearly flat
/// sets.
[[nodiscard]] Mat3 fitRotation(const Mat3& covariance, const Mat3& previous);

/// The same for several covariances, which is faster: about 0.05 us each if the rotations change little from frame to
/// frame.
/// @param rotations  in: previous ones; out: the fits
void fitRotations(std::span<const Mat3> covariances, std::span<Mat3> rotations);

/// The rotation and translation, without mirroring or scale, that bring `from` closest to `to` in the sum of squared
/// distances (Kabsch 1976). Flat sets have a unique solution. If the points do not determine the rotation (all on a
/// line, or all in one position), it is the one nearest to `previous`, so the motion of a body does not jump from frame
/// to frame.
/// @param from      points about their own centroid: their mean must be zero [m]
/// @param to        present position of each point, same count, at least one [m]
/// @param previous  rotation to stay near
[[nodiscard]] Isometry3 fitRigidMotion(std::span<const Vec3> from, std::span<const Vec3> to, const Mat3& previous);

}  // namespace lorica
