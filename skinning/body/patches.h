#pragma once

#include "geometry/tri_mesh.h"

#include <cstdint>
#include <vector>

namespace lorica {

/// A piece of surface whose triangles hang together by edges of exactly two of them.
struct Patch {
  double area = 0.0;  ///< [m^2]
  bool open = false;  ///< it has an edge of one triangle
};

struct Patches {
  std::vector<Patch> patches;
  std::vector<std::int32_t> patchOfTriangle;
  std::size_t openEdges = 0;
  std::size_t crowdedEdges = 0;     ///< of more than two triangles
  std::size_t turnedPatches = 0;    ///< that were inside out
  std::size_t turnedTriangles = 0;  ///< that faced another way than most of their patch
};

/// Divides a surface into patches and turns triangles so that those of one patch face the same way, and outward where
/// inside out is plain: a closed patch of negative volume, or an open one that bulges inward.
[[nodiscard]] Patches orientPatches(TriMesh& mesh);

}  // namespace lorica
