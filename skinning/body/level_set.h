#pragma once

#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <array>
#include <vector>

namespace lorica {

/// Numbers at the points of a grid. Internal to body/, as all of this file.
struct VoxelGrid {
  std::array<int, 3> size{};
  Vec3 origin = Vec3::Zero();  ///< of voxel 0, 0, 0 [m]
  std::vector<float> values;   ///< z runs fastest; distances in voxels

  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size[2]) +
           static_cast<std::size_t>(z);
  }
  [[nodiscard]] float at(int x, int y, int z) const { return values[index(x, y, z)]; }
};

/// Writes distances from triangles into a grid, in voxels; farther than `band` voxels is `band`.
/// @param voxel  edge [m]
/// @return success, or what is wrong: OpenVDB's words, or that its module cannot be loaded
[[nodiscard]] Result<void> unsignedDistances(VoxelGrid& grid, const TriMesh& mesh, double voxel, int band);

/// The surface at which a grid's values are 0: closed, though more than two triangles may meet in an edge.
/// @param grid   its outermost values are above 0
/// @param voxel  edge [m]
/// @return the mesh, without triangles where no value is below 0; or what is wrong
[[nodiscard]] Result<TriMesh> zeroSurface(const VoxelGrid& grid, double voxel);

}  // namespace lorica
