#pragma once

#include "geometry/tri_mesh.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Origin of a vertex of a repaired mesh: an input vertex, or the midpoint between two input vertices.
struct VertexOrigin {
  VertexIndex first = 0;
  VertexIndex second = 0;  ///< equal to `first`, except for the midpoint of an edge

  bool operator==(const VertexOrigin&) const = default;
};

/// Result of repairClosedMesh(), with the mapping of its vertices and triangles to the input.
struct MeshRepair {
  TriMesh mesh;                              ///< vertices of the input in its order, then the added vertices
  std::vector<VertexOrigin> origin;          ///< for each vertex
  std::vector<std::int32_t> sourceTriangle;  ///< for each triangle, the input triangle that it is or is part of

  std::size_t nonManifoldEdges = 0;    ///< edges with more than two triangles, separated
  std::size_t doubledVertices = 0;     ///< vertices added because the surface passed through a vertex more than once
  std::size_t halvedEdges = 0;         ///< edge midpoints added where duplicating the ends of the edge was not enough
  std::size_t repeatedCorners = 0;     ///< triangles removed because two corners are the same vertex
  std::size_t backToBack = 0;          ///< triangles removed in pairs with the same corners and opposite orientation
  std::size_t duplicateTriangles = 0;  ///< triangles removed because they occurred more than once

  [[nodiscard]] bool changed() const;
  /// The repairs in words: "2 non-manifold edges separated, 3 vertices duplicated". Empty if there were none.
  [[nodiscard]] std::string summary() const;
  /// Maps another pose of the input, such as a keyframe, to the repaired mesh.
  /// @param posed  one position for each vertex of the input
  /// @return one for each vertex of `mesh`
  [[nodiscard]] std::vector<Vec3> carried(std::span<const Vec3> posed) const;
};

/// Converts a mesh that is closed in a wider sense into a closed two-manifold. Closed in a wider sense: along each
/// edge, equally many triangles run in both directions, but more than two may share the edge.
///
/// At such a non-manifold edge the triangles are paired by angle: two triangles that bound the same wedge of solid form
/// a pair, so solids that touch along an edge are separated there. Vertices are duplicated where necessary. If the
/// surface is connected around both ends of the edge, its second passage gets a vertex at the midpoint of the edge.
/// Removed triangles: those with a repeated corner, back-to-back pairs at non-manifold edges, and copies of a triangle
/// that prevent an edge from being closed. No vertex is moved or removed, and the enclosed volume does not change. A
/// mesh that needs no repair is returned unchanged.
/// @return the repaired mesh, or the error of checkClosedTwoManifold() if the mesh is not closed in this sense
[[nodiscard]] Result<MeshRepair> repairClosedMesh(const TriMesh& mesh);

}  // namespace lorica
