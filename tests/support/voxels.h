#pragma once

#include "geometry/tri_mesh.h"

#include <array>
#include <set>

namespace lorica::test {

using Voxel = std::array<int, 3>;

/// The surface of a union of unit cubes with corners at whole numbers, one vertex a corner. Where cubes touch in an
/// edge only, four triangles meet there: closed, but not a two-manifold.
[[nodiscard]] TriMesh makeVoxelSurface(const std::set<Voxel>& voxels);

}  // namespace lorica::test
