#pragma once

#include "collision/particles/particle_bodies.h"
#include "collision/world/part_shape.h"
#include "collision/world/prop.h"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>
#include <vector>

namespace lorica {

/// The hulls of a mesh, in the frame of its principal axes. All props of one mesh share them. Internal.
struct PropHulls {
  std::vector<std::unique_ptr<PartShape>> shapes;
  std::vector<ParticleBody::Hull> faces;  ///< for particles
};

/// A prop's rigid body in Bullet. Internal.
///
/// In Bullet, a body's origin is its centre of mass and its axes are the principal axes. For all props except meshes
/// this is the prop's own frame.
struct PropBody {
  std::shared_ptr<const PropHulls> hulls;  ///< of a mesh
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btRigidBody> body;
  Isometry3 massFromProp = Isometry3::Identity();
  double volume = 0.0;  ///< [m^3]
  double radius = 0.0;  ///< around the centre of mass [m]
  bool round = false;
  bool centered = true;       ///< massFromProp is the identity
  double stillSeconds = 0.0;  ///< in a crowd: how long it has been still, awake

  /// Bound on the speed that rotation gives the surface [m/s]; 0 for a ball, whose rotation does not change its shape.
  [[nodiscard]] double spin() const { return round ? 0.0 : radius * body->getAngularVelocity().length(); }
  /// Upper bound on the speed of any point [m/s].
  [[nodiscard]] double speed() const { return body->getLinearVelocity().length() + spin(); }
  /// Writes the body's pose and velocities to the prop.
  void read(Prop& prop) const;
  /// As particles meet it, at rest where it is.
  [[nodiscard]] ParticleBody forParticles(const Prop& prop) const;
  [[nodiscard]] ParticleBody::Motion motion() const;
  /// Takes over what particles made of its motion.
  void move(const ParticleBody::Motion& motion);
};

/// @param index  of the prop, reported in contacts
/// @param same   of the same mesh, if there is one: a large hull takes a second to make
[[nodiscard]] PropBody makePropBody(const Prop& prop, int index, const PropBody* same = nullptr);

}  // namespace lorica
