#include "skinning/springs/spring_collider.h"

#include <algorithm>

namespace lorica {

namespace {

/// From the nearest point of a capsule's axis, or of a sphere's centre, to a point.
[[nodiscard]] Vec3 fromAxis(const SpringCollider& collider, const Affine3& worldFromJoint, const Vec3& point) {
  const Vec3 begin = worldFromJoint * collider.offset;
  const bool capsule =
      collider.shape == SpringColliderShape::kCapsule || collider.shape == SpringColliderShape::kInsideCapsule;
  if (!capsule) return point - begin;
  const Vec3 axis = worldFromJoint * collider.tail - begin;
  const double lengthSq = axis.squaredNorm();
  const double along = lengthSq > 0.0 ? std::clamp(axis.dot(point - begin) / lengthSq, 0.0, 1.0) : 0.0;
  return point - begin - along * axis;
}

}  // namespace

std::optional<SpringHit> hitCollider(const SpringCollider& collider, const Affine3& worldFromJoint, const Vec3& center,
                                     double radius) {
  if (collider.shape == SpringColliderShape::kPlane) {
    // Normals turn with the inverse transpose; the cofactors are that up to a factor, and exist for every matrix.
    const Mat3 linear = worldFromJoint.linear();
    const Vec3 normal = linear.col(1).cross(linear.col(2)) * collider.normal.x() +
                        linear.col(2).cross(linear.col(0)) * collider.normal.y() +
                        linear.col(0).cross(linear.col(1)) * collider.normal.z();
    const double length = normal.norm();
    if (!(length > 0.0)) return std::nullopt;
    const Vec3 unit = normal * ((linear.determinant() < 0.0 ? -1.0 : 1.0) / length);
    const double distance = unit.dot(center - worldFromJoint * collider.offset) - radius;
    return distance < 0.0 ? std::optional(SpringHit{unit, -distance}) : std::nullopt;
  }
  const Vec3 outward = fromAxis(collider, worldFromJoint, center);
  const double length = outward.norm();
  const bool inside =
      collider.shape == SpringColliderShape::kInsideSphere || collider.shape == SpringColliderShape::kInsideCapsule;
  const double distance = inside ? collider.radius - radius - length : length - radius - collider.radius;
  if (!(distance < 0.0) || !(length > 0.0)) return std::nullopt;
  return SpringHit{outward * ((inside ? -1.0 : 1.0) / length), -distance};
}

}  // namespace lorica
