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

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Vec3 = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;
using Mat4 = Eigen::Matrix4d;
using Quat = Eigen::Quaterniond;
using Affine3 = Eigen::Affine3d;
using Isometry3 = Eigen::Isometry3d;

/// Axis-aligned bounding box; empty until a point is added.
struct Aabb {
  Vec3 min{kInfinity, kInfinity, kInfinity};
  Vec3 max{-kInfinity, -kInfinity, -kInfinity};

  void extend(const Vec3& p) {
    for (int i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], p[i]);
      max[i] = std::max(max[i], p[i]);
    }
  }
  [[nodiscard]] bool empty() const { return min[0] > max[0]; }
  [[nodiscard]] Vec3 center() const;
  [[nodiscard]] double diagonal() const;  ///< 0 when empty
};

[[nodiscard]] Aabb boundsOf(std::span<const Vec3> points);

// Eigen templates that take seconds to compile are wrapped here and compiled once.

/// Returns the shortest rotation that maps one direction to another; the vectors need not be normalized.
[[nodiscard]] Quat rotationBetween(const Vec3& from, const Vec3& to);
[[nodiscard]] Eigen::Quaternionf rotationBetween(const Vec3f& from, const Vec3f& to);

/// Eigenvalues in ascending order; the columns of `vectors` are the unit eigenvectors in the same order.
struct SymmetricAxes {
  Vec3 values;
  Mat3 vectors;
};
/// @param matrix  symmetric; only its lower triangle is read
[[nodiscard]] SymmetricAxes symmetricAxes(const Mat3& matrix);

}  // namespace lorica
