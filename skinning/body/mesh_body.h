#pragma once

#include "skinning/body/closed_body.h"

namespace lorica {

/// A closed body for a mesh that is no character. Lengths are in the mesh's unit, whatever that is.
struct MeshBody {
  /// `triangles` is a closed two-manifold. Vertices: first those of the body, then those of the original mesh, in its
  /// order and unchanged, which no triangle uses.
  TriMesh mesh;
  VertexIndex firstOriginal = 0;  ///< vertex v of the original is vertex firstOriginal + v of `mesh`
  double resolution = 0.0;        ///< voxel edge
  BodyDistances distances;        ///< between the body and the original
};

/// Builds a closed surface around a mesh, see makeBody(); also if the mesh is closed already.
///
/// The mesh is moved and scaled to a longest side of 1, and its positions are rounded to 1e-12 of it, so that the body
/// does not depend on the mesh's unit.
/// @param settings  resolution: in the mesh's unit
/// @return the body, or an error if the triangles enclose nothing or the mesh has no size
[[nodiscard]] Result<MeshBody> makeMeshBody(const TriMesh& mesh, const BodySettings& settings = {});

/// A closed surface at half of a thickness from a mesh, whatever it consists of. Space that cannot be reached from
/// outside is filled.
/// @param thickness  more than 0 [the mesh's unit]; at least twice a 96th of the longest side is used, and more where
///                   very many triangles lie on each other
/// @return the body, with `resolution` set and without the original's vertices; or an error
[[nodiscard]] Result<MeshBody> makeShellBody(const TriMesh& mesh, double thickness);

}  // namespace lorica
