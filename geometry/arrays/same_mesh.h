#pragma once

#include "geometry/tri_mesh.h"

#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Finds out whether two meshes differ in nothing but the order of their points, triangles and corners. Internal: not
/// installed.
/// @param wanted  triangles of the first
/// @param near    its points, near to those of the other: where a mesh is symmetric, that tells which is which
/// @return for each point of the first the index of its point in the other; none if they are different meshes, or if
///         telling takes too long, which only happens to meshes without a border that are as regular as a torus
[[nodiscard]] std::optional<std::vector<VertexIndex>> sameMesh(std::span<const Triangle> wanted,
                                                               std::span<const Vec3> near, const TriMesh& other);

}  // namespace lorica
