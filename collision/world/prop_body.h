#pragma once

#include "collision/world/part_shape.h"
#include "collision/world/prop.h"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>
#include <vector>

namespace lorica {

/// A prop's body in Bullet. Internal.
///
/// Bullet has a body's origin at its centre of mass and its axes along the principal ones. For all props but meshes
/// that is the prop's own frame already.
struct PropBody {
  std::vector<std::unique_ptr<PartShape>> hulls;  ///< of a mesh, in the frame of its mass
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btRigidBody> body;
  Isometry3 massFromProp = Isometry3::Identity();
  double radius = 0.0;  ///< around the centre of mass [m]
  bool round = false;
  bool centered = true;  ///< massFromProp is the identity

  /// How fast the surface goes about the middle [m/s]; that of a ball stays in its place.
  [[nodiscard]] double spin() const { return round ? 0.0 : radius * body->getAngularVelocity().length(); }
  /// No point is faster [m/s].
  [[nodiscard]] double speed() const { return body->getLinearVelocity().length() + spin(); }
  /// Writes where the body is, and how it moves.
  void read(Prop& prop) const;
};

/// @param index  of the prop, for contacts
[[nodiscard]] PropBody makePropBody(const Prop& prop, int index);

}  // namespace lorica
