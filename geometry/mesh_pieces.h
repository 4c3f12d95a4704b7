#pragma once

/// Pieces of a surface and the way they face. Internal: not installed.

#include "geometry/tri_mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lorica {

/// Pieces of surface: triangles connected by edges that exactly two triangles share.
struct MeshPieces {
  std::vector<std::vector<std::int32_t>> members;  ///< triangles of each piece, from neighbour to neighbour
  std::vector<std::int32_t> pieceOfTriangle;
  std::vector<bool> open;           ///< for each piece: one of its edges has only one triangle
  std::vector<Triangle> triangles;  ///< of the mesh; those of one piece face the same way, as most of its area does
  std::size_t turned = 0;           ///< triangles that faced the other way
  bool orientable = true;           ///< false if a piece is one-sided, like a Moebius strip
  std::size_t openEdges = 0;
  std::size_t nonManifoldEdges = 0;  ///< with more than two triangles
};

[[nodiscard]] MeshPieces findPieces(const TriMesh& mesh);

struct TurnedPieces {
  std::size_t pieces = 0;
  std::size_t reversed = 0;  ///< of these pieces
};

/// Makes the pieces of a closed two-manifold face outward; whole pieces are reversed.
///
/// A piece that lies in no other one is solid: if its volume is negative, it is reversed, and the pieces inside it
/// alternate with depth: a cavity, a solid in the cavity, ... Otherwise pieces inside others stay as they are, so
/// cavities stay cavities; a cavity outside every solid does not exist and becomes solid. With more than 500,000 pairs
/// of a piece and one around it all stay as they are.
TurnedPieces turnPiecesOutward(TriMesh& mesh);

}  // namespace lorica
