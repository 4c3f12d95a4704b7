#pragma once

#include "collision/world/world.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A mesh shared by all props of one shape. The vertex shader places a vertex at corner * extents + normal * bevel, so
/// one mesh serves boxes of all proportions with equal bevels.
struct PropMesh {
  struct Vertex {
    Vec3f corner;  ///< position without bevel, in half extents; zero on a sphere
    Vec3f normal;
  };
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
};

/// Of a box with bevelled edges: 96 vertices, 108 triangles. Of a sphere: 360 vertices, 624 triangles. Of a capsule
/// about y: the two separated halves of a sphere. Of a cylinder about y: with bevelled rims. A prop with a mesh has its
/// own.
[[nodiscard]] PropMesh makePropMesh(PropShape shape);

/// Vertex shader input of one prop.
struct PropInstance {
  Vec3f x, y, z, origin;  ///< columns of worldFromProp
  Vec3f extents;          ///< half extents minus the bevel [m]
  float bevel;            ///< for a sphere or capsule, the radius [m]
  Vec3f color;            ///< linear RGB
  float opacity;          ///< 0 to 1
};

/// What a camera sees: where it is and what no prop must hide from it.
struct UnhiddenView {
  Vec3 eye;
  std::optional<Aabb> subject;  ///< none = props may hide everything

  /// Opacity of a prop: low if it may hide a part of the subject.
  [[nodiscard]] float opacityOf(const Prop& prop) const;
};

/// Instances of all props of one shape; props with non-finite numbers are omitted.
void makePropInstances(std::span<const Prop> props, PropShape shape, std::vector<PropInstance>& instances,
                       const UnhiddenView& view = {});

/// A mesh to draw with extents 1 and bevel 0. Edges between faces at more than 40 degrees are sharp, other edges have
/// smooth normals. Three vertices per triangle. Triangles with non-finite coordinates are omitted.
[[nodiscard]] PropMesh makeCreasedMesh(const TriMesh& mesh);

}  // namespace lorica
