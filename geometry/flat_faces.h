#pragma once

#include "geometry/tri_mesh.h"

#include <cstdint>
#include <vector>

namespace lorica {

/// Triangles over the vertices of a mesh.
struct FlatFaces {
  std::vector<Triangle> triangles;    ///< each with its smallest vertex first; ascending
  std::vector<std::int32_t> sources;  ///< for each, a triangle of the mesh that it has area of
};

/// The same surface with as few triangles as its flat faces need: however a flat face is divided, it comes out alike.
///
/// Vertices inside a flat face go, and those on a straight edge between two flat faces or along the border of one. Then
/// the triangles of each face are made as even as they can be (Delaunay). Flat is what is within 3e-7 of the
/// diagonal of a plane, and straight of a line.
/// @param mesh  welded, for triangles are neighbors only by the vertices they share
/// @return as given where the surface is not a manifold, and if nothing is flat, positions are not finite or indices
///         are out of range
[[nodiscard]] FlatFaces mergeFlatFaces(const TriMesh& mesh);

}  // namespace lorica
