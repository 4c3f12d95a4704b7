#pragma once

/// Conventions of the whole project: metres, seconds, radians; right-handed axes, Y up; column vectors.
/// A character in its bind pose faces +Z, so its own left hand is at +X.
/// A transform names both ends: worldFromJoint = worldFromParent * parentFromJoint.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <limits>
#include <span>

namespace lorica {

using Vec3 = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;
using Mat4 = Eigen::Matrix4d;
using Quat = Eigen::Quaterniond;
using Affine3 = Eigen::Affine3d;
using Isometry3 = Eigen::Isometry3d;

/// Axis-aligned bounding box; empty until a point is added.
struct Aabb {
  Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 max = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void extend(const Vec3& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  [[nodiscard]] bool empty() const { return min.x() > max.x(); }
  [[nodiscard]] Vec3 center() const { return 0.5 * (min + max); }
  [[nodiscard]] double diagonal() const { return empty() ? 0.0 : (max - min).norm(); }
};

[[nodiscard]] inline Aabb boundsOf(std::span<const Vec3> points) {
  Aabb box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

}  // namespace lorica
