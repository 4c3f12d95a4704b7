#pragma once

#include "geometry/tri_mesh.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A vertex of a repaired mesh: the vertex of the input that it stands for, or the middle between two of them.
struct VertexOrigin {
  VertexIndex first = 0;
  VertexIndex second = 0;  ///< the same as `first`, but for the middle of an edge

  bool operator==(const VertexOrigin&) const = default;
};

/// What repairClosedMesh made of a mesh, and how to take along what belongs to its vertices and triangles.
struct MeshRepair {
  TriMesh mesh;                              ///< vertices of the input in its order, then the added ones
  std::vector<VertexOrigin> origin;          ///< for each vertex
  std::vector<std::int32_t> sourceTriangle;  ///< for each triangle, the one of the input that it is or is a piece of

  std::size_t crowdedEdges = 0;     ///< edges of more than two triangles, parted
  std::size_t doubledVertices = 0;  ///< vertices added because the surface passed through one place twice
  std::size_t halvedEdges = 0;      ///< vertices added in the middle of an edge, where doubling its ends was not enough
  std::size_t repeatedCorners = 0;  ///< triangles dropped because two of their corners are one vertex
  std::size_t backToBack = 0;       ///< triangles dropped in pairs of the same corners that face opposite ways
  std::size_t duplicateTriangles = 0;  ///< triangles dropped because they were there twice

  [[nodiscard]] bool changed() const;
  /// What was done, in words: "2 edges of more than two triangles parted, 3 vertices doubled". Empty if nothing.
  [[nodiscard]] std::string summary() const;
  /// Positions of the repaired mesh in another pose of the input, such as a keyframe.
  /// @param posed  one position for each vertex of the input
  /// @return one for each vertex of `mesh`
  [[nodiscard]] std::vector<Vec3> carried(std::span<const Vec3> posed) const;
};

/// Makes a closed two-manifold of a mesh that is closed in a wider sense: as many triangles run along each edge one way
/// as the other, but more than two may meet at it.
///
/// Around such an edge the triangles are paired by angle, those on both sides of a wedge of solid together, so that
/// solids which touch in an edge come apart there; vertices are doubled as far as that needs. Where the surface is
/// joined round both ends of the edge, its second passage gets a vertex in the middle of the edge. Dropped are
/// triangles with a repeated corner, pairs of triangles back to back at edges of more than two, and copies of a
/// triangle that keep an edge from being closed. No vertex moves and none is removed, the enclosed volume stays the
/// same; a mesh that needs none of this comes back as it was.
/// @return the repaired mesh, or checkClosedTwoManifold's sentence where the mesh is not closed even so
[[nodiscard]] Result<MeshRepair> repairClosedMesh(const TriMesh& mesh);

}  // namespace lorica
