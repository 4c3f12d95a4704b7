#pragma once

/// Small holes of a surface. Internal: not installed.

#include "geometry/tri_mesh.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace lorica {

/// A hole is a pinhole if it has at most this many edges, ...
inline constexpr std::size_t kPinholeEdges = 64;
/// ... its longest extent is at most this share of the surface's diagonal (any size if it has three edges: one triangle
/// is missing), ...
inline constexpr double kPinholeExtent = 0.05;
/// ... or its cap has at most this share of the connected piece's area: a slit, ...
inline constexpr double kSlitArea = 0.002;
/// ... and all holes of a connected piece have at most this share of the piece's area. A flat card is not a pinhole's
/// surroundings.
inline constexpr double kPinholeArea = 0.5;
/// Fins, triangles that a cap would close into a body without volume, have at most this share of their piece's area.
inline constexpr double kFinArea = 0.01;

struct Pinholes {
  std::size_t count = 0;
  std::vector<Triangle> caps;  ///< to be added to the mesh
};

/// Finds the holes of a surface and triangles that close them: those with the least area in total. They add no vertex.
/// Where a cap is the reverse of a triangle that is there, that one is a fin: repairClosedMesh() drops both.
/// @param mesh  triangles of one piece must face the same way
/// @return nothing if a hole is not a pinhole, if fins have too much area, or if a hole cannot be closed without
/// folding:
///         if two neighbouring triangles of its cap would face away from each other by more than 120 degrees
[[nodiscard]] std::optional<Pinholes> closePinholes(const TriMesh& mesh);

}  // namespace lorica
