#pragma once

#include "acd/decomposition.h"
#include "geometry/mesh_files.h"

#include <span>
#include <vector>

namespace lorica {

/// The parts' hulls as they go to a file: one object a part, o part_0, o part_1, ...
struct HullExport {
  std::vector<NamedMesh> objects;
  std::vector<double> growth;          ///< for each part, volume / volume of the hull that has all vertices
  double totalGrowth = 1.0;            ///< the same for the sums over the parts
  std::size_t mostVertices = 0;        ///< of a hull as exported
  std::size_t mostVerticesBefore = 0;  ///< of a hull with all its vertices
};

/// @param vertices     of the mesh, in the pose to export
/// @param maxVertices  hulls with more become larger ones with so many: see simplifyHull(). 0 = leave them as they are
[[nodiscard]] HullExport exportHulls(const Decomposition& decomposition, std::span<const Vec3> vertices,
                                     int maxVertices, int threads);

}  // namespace lorica
