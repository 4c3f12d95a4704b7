#pragma once

#include "skinning/body/level_set.h"

namespace lorica {

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
