#pragma once

#include "collision/world/world.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// A shape that all props of one kind share. The vertex shader places a vertex at
/// corner * extents + normal * bevel, so one mesh serves boxes of any proportion with equal bevels.
struct PropMesh {
  struct Vertex {
    Vec3f corner;  ///< where it is without bevel, in half extents; zero on a sphere
    Vec3f normal;
  };
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
};

/// Box with bevelled edges: 96 vertices, 108 triangles.
[[nodiscard]] PropMesh makeBevelledBox();

/// Sphere of 360 vertices and 624 triangles.
[[nodiscard]] PropMesh makePropSphere();

/// Capsule about y: the two halves of a sphere apart.
[[nodiscard]] PropMesh makePropCapsule();

/// Cylinder about y with bevelled rims.
[[nodiscard]] PropMesh makePropCylinder();

[[nodiscard]] PropMesh makePropMesh(PropShape shape);

/// What the vertex shader needs of one prop.
struct PropInstance {
  Vec3f x, y, z, origin;  ///< columns of worldFromProp
  Vec3f extents;          ///< half extents less the bevel [m]
  float bevel;            ///< the radius for a sphere or capsule [m]
  Vec3f color;            ///< linear RGB
};

/// Every prop of one shape; those with numbers that are not finite are left out.
void makePropInstances(std::span<const Prop> props, PropShape shape, std::vector<PropInstance>& instances);

}  // namespace lorica
