#pragma once

#include "skinning/springs/spring_bones.h"

#include <optional>

namespace lorica {

/// How deep a ball is inside a collider, and the way out.
struct SpringHit {
  Vec3 direction = Vec3::UnitY();  ///< world, unit
  double depth = 0.0;              ///< [m], above 0
};

/// @param worldFromJoint  of the collider's joint
/// @param center,radius   of the ball, world [m]
/// @return nothing if they do not touch, or if no direction leads out
[[nodiscard]] std::optional<SpringHit> hitCollider(const SpringCollider& collider, const Affine3& worldFromJoint,
                                                   const Vec3& center, double radius);

}  // namespace lorica
