#pragma once

#include "geometry/convex_hull.h"
#include "geometry/mass_properties.h"
#include "geometry/math.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace lorica {

/// See Prop::halfExtents; kMesh has hulls of its own.
enum class PropShape : std::uint8_t { kBox, kSphere, kCapsule, kCylinder, kMesh };
/// Number of primitive shapes, which precede kMesh.
inline constexpr int kPropShapeCount = 4;

/// Shape of a prop of type kMesh: convex hulls for collision and a mesh for rendering, in the prop's own frame. Shared
/// by all identical props.
struct PropMeshShape {
  std::vector<ConvexHull> hulls;  ///< at least one, none degenerate
  TriMesh shown;                  ///< what is drawn
  MassProperties solid;           ///< mass distribution: that of a homogeneous solid of this volume
};

/// A rigid body of the virtual world.
struct Prop {
  PropShape shape = PropShape::kBox;  ///< says what halfExtents means
  /// Box: half its sides; sphere: x is the radius; capsule and cylinder: axis along the prop's y, x is the radius, y
  /// half the height including caps; mesh: half the sides of its bounding box, whose centre is the origin [m].
  Vec3 halfExtents = Vec3::Constant(0.1);
  double mass = 1.0;         ///< [kg]; 0 = static body, which nothing moves and which the avatar passes through
  double friction = 0.6;     ///< with a floor or another prop: of both, the product
  double restitution = 0.2;  ///< 0 = does not bounce; of two things, the product
  Isometry3 worldFromProp = Isometry3::Identity();  ///< [m]
  Vec3 velocity = Vec3::Zero();               ///< of the centre of mass, which is the origin except for a mesh [m/s]
  Vec3 angularVelocity = Vec3::Zero();        ///< world axes [rad/s]
  Vec3f color = Vec3f(0.8f, 0.5f, 0.2f);      ///< linear RGB, 0 to 1
  std::shared_ptr<const PropMeshShape> mesh;  ///< of shape kMesh only
};

/// Radius of the bounding sphere around a prop's origin [m].
[[nodiscard]] double boundingRadius(const Prop& prop);

/// A prop of shape kMesh, at rest at the world's origin.
[[nodiscard]] Prop meshProp(std::shared_ptr<const PropMeshShape> mesh);

}  // namespace lorica
