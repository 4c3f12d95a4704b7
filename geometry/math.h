#pragma once

/// Conventions of the project: metres, seconds, radians; right-handed axes, Y up; column vectors.
/// A character in its bind pose faces +Z, so its left hand is at +X.
/// Names of transforms contain both frames: worldFromJoint = worldFromParent * parentFromJoint.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <span>

namespace lorica {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();  ///< what minima start from

using Vec3 = Eigen::Vector3d;         ///< a point or direction; points in metres
using Vec3f = Eigen::Vector3f;        ///< the same in single precision
using Mat3 = Eigen::Matrix3d;         ///< row, column; column vectors
using Mat4 = Eigen::Matrix4d;         ///< homogeneous; column vectors
using Quat = Eigen::Quaterniond;      ///< a rotation if it is a unit quaternion; the constructor takes w, x, y, z
using Affine3 = Eigen::Affine3d;      ///< rotation, scale, shear and translation [m]
using Isometry3 = Eigen::Isometry3d;  ///< rotation and translation [m]

/// Axis-aligned bounding box; empty until a point is added.
struct Aabb {
  Vec3 min{kInfinity, kInfinity, kInfinity};     ///< [m]
  Vec3 max{-kInfinity, -kInfinity, -kInfinity};  ///< [m]

  /// Grows to hold a point.
  void extend(const Vec3& p) {
    for (int i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], p[i]);
      max[i] = std::max(max[i], p[i]);
    }
  }
  [[nodiscard]] bool empty() const { return min[0] > max[0]; }  ///< no point was added
  [[nodiscard]] Vec3 center() const;                            ///< [m]
  [[nodiscard]] double diagonal() const;                        ///< 0 when empty
};

/// The smallest box around points; empty without any.
[[nodiscard]] Aabb boundsOf(std::span<const Vec3> points);

// Eigen templates that take seconds to compile are wrapped here and compiled once.

/// Returns the shortest rotation that maps one direction to another; the vectors need not be normalized.
[[nodiscard]] Quat rotationBetween(const Vec3& from, const Vec3& to);
/// The same in single precision.
[[nodiscard]] Eigen::Quaternionf rotationBetween(const Vec3f& from, const Vec3f& to);

/// Eigenvalues in ascending order; the columns of `vectors` are the unit eigenvectors in the same order.
struct SymmetricAxes {
  Vec3 values;   ///< ascending
  Mat3 vectors;  ///< a unit eigenvector in each column
};
/// @param matrix  symmetric; only its lower triangle is read
[[nodiscard]] SymmetricAxes symmetricAxes(const Mat3& matrix);

}  // namespace lorica
