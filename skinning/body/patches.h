#pragma once

#include "geometry/tri_mesh.h"

#include <cstdint>
#include <vector>

namespace lorica {

/// A piece of surface whose triangles are connected by edges with exactly two triangles.
struct Patch {
  double area = 0.0;  ///< [m^2]
  bool open = false;  ///< it has an edge with only one triangle
};

struct Patches {
  std::vector<Patch> patches;
  std::vector<std::int32_t> patchOfTriangle;
  std::size_t openEdges = 0;
  std::size_t nonManifoldEdges = 0;  ///< with more than two triangles
  std::size_t turnedPatches = 0;     ///< that were inside out
  std::size_t turnedTriangles = 0;   ///< that were oriented against most of their patch
};

/// Divides a surface into patches and flips triangles so that those of one patch face the same way. Patches that are
/// clearly inside out are flipped outward: closed ones of negative volume, and open ones that bulge inward.
[[nodiscard]] Patches orientPatches(TriMesh& mesh);

}  // namespace lorica
