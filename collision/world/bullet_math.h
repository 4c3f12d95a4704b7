#pragma once

#include "geometry/math.h"

#include <LinearMath/btTransform.h>

namespace lorica {

/// Conversions between Lorica's double-precision types and Bullet's single-precision ones. Internal.

inline btVector3 toBullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

inline btTransform toBullet(const Quat& rotation, const Vec3& origin) {
  const btQuaternion q(static_cast<btScalar>(rotation.x()), static_cast<btScalar>(rotation.y()),
                       static_cast<btScalar>(rotation.z()), static_cast<btScalar>(rotation.w()));
  return btTransform(q.normalized(), toBullet(origin));
}

inline Vec3 fromBullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

inline Isometry3 fromBullet(const btTransform& t) {
  const btQuaternion q = t.getRotation();
  Isometry3 result = Isometry3::Identity();
  result.linear() = Quat(q.w(), q.x(), q.y(), q.z()).normalized().toRotationMatrix();
  result.translation() = fromBullet(t.getOrigin());
  return result;
}

}  // namespace lorica
