#pragma once

#include "geometry/tri_mesh.h"

#include <array>
#include <set>

namespace lorica::test {

using Voxel = std::array<int, 3>;

/// The surface of a union of unit cubes with corners at integer positions, one vertex per corner. If cubes touch only
/// along an edge, four triangles share it: closed, but not a two-manifold.
[[nodiscard]] TriMesh makeVoxelSurface(const std::set<Voxel>& voxels);

}  // namespace lorica::test
