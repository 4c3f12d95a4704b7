#pragma once

#include "geometry/convex_hull.h"
#include "geometry/mass_properties.h"
#include "geometry/math.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace lorica {

enum class PropShape : std::uint8_t { kBox, kSphere, kCapsule, kCylinder, kMesh };
/// The shapes before kMesh: those that a few numbers describe.
inline constexpr int kPropShapeCount = 4;

/// What props of shape kMesh are: convex hulls to be touched and a mesh to be seen, in the prop's own frame. Shared by
/// all props that are alike.
struct PropMeshShape {
  std::vector<ConvexHull> hulls;  ///< at least one, none degenerate
  TriMesh shown;
  MassProperties solid;  ///< how the prop's mass is spread: as in a solid of this volume
};

/// A rigid body of the virtual world.
struct Prop {
  PropShape shape = PropShape::kBox;
  /// Box: half its sides; sphere: x is the radius; capsule and cylinder: about the prop's y axis, x is the radius, y
  /// half the height, caps included; mesh: half the sides of the box around it, whose middle is the origin [m].
  Vec3 halfExtents = Vec3::Constant(0.1);
  double mass = 1.0;  ///< [kg]; 0 = furniture, which nothing moves and which the avatar passes through
  double friction = 0.6;
  double restitution = 0.2;
  Isometry3 worldFromProp = Isometry3::Identity();
  Vec3 velocity = Vec3::Zero();               ///< of the centre of mass, which is the origin but for a mesh [m/s]
  Vec3 angularVelocity = Vec3::Zero();        ///< world axes [rad/s]
  Vec3f color = Vec3f(0.8f, 0.5f, 0.2f);      ///< linear RGB, 0 to 1
  std::shared_ptr<const PropMeshShape> mesh;  ///< of shape kMesh only
};

/// Of the sphere around a prop's origin that holds it [m].
[[nodiscard]] double boundingRadius(const Prop& prop);

/// A prop of shape kMesh, at rest at the world's origin.
[[nodiscard]] Prop meshProp(std::shared_ptr<const PropMeshShape> mesh);

}  // namespace lorica
