#pragma once

#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <array>
#include <vector>

namespace lorica {

/// Values at the points of a grid. Internal to body/, like everything in this file.
struct VoxelGrid {
  std::array<int, 3> size{};
  Vec3 origin = Vec3::Zero();  ///< position of voxel (0, 0, 0) [m]
  std::vector<float> values;   ///< z varies fastest; distances in voxels

  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * size[1] + y) * size[2] + z;
  }
  [[nodiscard]] float at(int x, int y, int z) const { return values[index(x, y, z)]; }
};

/// Writes the distances to triangles into a grid, in voxels, at most `band`.
/// @param voxel  edge [m]
/// @return success; or an error with OpenVDB's message, or if its module cannot be loaded
[[nodiscard]] Result<void> unsignedDistances(VoxelGrid& grid, const TriMesh& mesh, double voxel, int band);

/// The isosurface at value 0: closed, but more than two triangles may share an edge.
/// @param grid   its outermost values are above 0
/// @param voxel  edge [m]
/// @return the mesh, without triangles if no value is below 0; or an error
[[nodiscard]] Result<TriMesh> zeroSurface(const VoxelGrid& grid, double voxel);

/// The functions of level_set.h, implemented with OpenVDB. OpenVDB takes longer to load than all other libraries
/// together, so it is in a separate module, loaded when a body is first built; only one source file includes its
/// headers.
struct LevelSetModule {
  Result<void> (*unsignedDistances)(VoxelGrid& grid, const TriMesh& mesh, double voxel, int band);
  Result<TriMesh> (*zeroSurface)(const VoxelGrid& grid, double voxel);
};

/// Symbol name of the module's constant.
inline constexpr const char* kLevelSetSymbol = "loricaLevelSet";

}  // namespace lorica
