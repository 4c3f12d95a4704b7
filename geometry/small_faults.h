#pragma once

#include "geometry/tri_mesh.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lorica {

/// Result of repairSmallFaults().
struct FaultRepair {
  TriMesh mesh;  ///< vertices of the input in its order, then those that repairs and unions added
  /// Vertices that triangles of the input use but none of `mesh`, ascending: those welded to others, and those of
  /// dropped specks. Those inside a union of pieces are not among them.
  std::vector<VertexIndex> leftOut;

  std::size_t weldedVertices = 0;     ///< to others within a millionth of the diagonal
  std::size_t repeatedCorners = 0;    ///< triangles dropped because two corners are the same vertex
  std::size_t repeatedTriangles = 0;  ///< triangles dropped because another has the same corners
  std::size_t specks = 0;             ///< open pieces dropped because they are tiny
  std::size_t turnedTriangles = 0;    ///< triangles that faced the other way than most of their piece
  std::size_t pinholes = 0;           ///< holes closed
  std::size_t capTriangles = 0;       ///< triangles added to close them
  bool reversed = false;              ///< the whole mesh was inside out
  std::size_t reversedPieces = 0;     ///< pieces that were inside out
  std::size_t unitedPieces = 0;       ///< closed pieces that overlapped others
  double volume = 0.0;                ///< of their union and all other pieces, ...
  double sumOfVolumes = 0.0;          ///< and what was their sum, if pieces were united
  std::string repaired;               ///< what repairClosedMesh() did, in words; empty = nothing

  [[nodiscard]] bool changed() const;
  /// What was repaired, in words: "reversed, for it was inside out, 3 pinholes closed with 7 triangles". Empty if
  /// nothing.
  [[nodiscard]] std::string summary() const;
};

/// The mesh with vertices at the same position welded, see repairSmallFaults(), without triangles that have a repeated
/// corner or repeat another one, whichever way they face.
/// @param mesh  finite, with indices in range
[[nodiscard]] TriMesh withoutRepeats(const TriMesh& mesh);

/// Open pieces whose longest extent is at most this share of the mesh's diagonal are specks, ...
inline constexpr double kSpeckExtent = 0.01;
/// ... if all of them together have at most this share of its area.
inline constexpr double kSpeckArea = 0.01;

/// Turns a mesh with small faults into a closed two-manifold that faces outward, without moving a vertex.
///
/// In this order: vertices within a millionth of the diagonal of each other are welded if that closes edges; triangles
/// with a repeated corner and repeated triangles are dropped; so are specks; within each piece of surface all triangles
/// are turned to face as most of its area does; pinholes are closed without a new vertex; non-manifold edges are
/// separated, see repairClosedMesh(); pieces are turned outward.
///
/// A pinhole has three edges (one triangle is missing); or at most 64, and an extent of at most 5 % of the mesh's
/// diagonal or a cap of at most 0.2 % of the piece's area (a slit). A triangle that stands out
/// alone as a fin goes, if all fins have at most 1 % of it. The holes of a connected piece together have at most half
/// of the piece's area: a card is not a pinhole's surroundings. A pinhole is closed by the triangles with the smallest
/// area; a hole that they would fold over is too much.
///
/// Outward: a piece that is in no other one encloses volume. If it has to be reversed, the pieces in it alternate with
/// their depth: a cavity, a solid in the cavity, ... Else a piece in a solid stays as it is: a cavity stays a cavity.
///
/// Last, pieces that overlap are united: volume counts once.
///
/// A mesh that is a closed two-manifold already is returned unchanged, except that inside-out pieces which are in no
/// solid are reversed and overlapping ones united.
/// @return the repaired mesh, or an error if the faults are not small: that of checkClosedTwoManifold(), or that pieces
///         overlap in a way that cannot be resolved
[[nodiscard]] Result<FaultRepair> repairSmallFaults(const TriMesh& mesh);

/// Keeps the first of triangles with the same three corners, whichever way they face: two-sided triangles enclose
/// nothing.
/// @return the number of dropped triangles
std::size_t dropDuplicates(std::vector<Triangle>& triangles);

}  // namespace lorica
