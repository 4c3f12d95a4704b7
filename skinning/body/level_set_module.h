#pragma once

#include "skinning/body/level_set.h"

namespace lorica {

/// The functions of level_set.h as OpenVDB does them. It takes longer to load than all other libraries together, so it
/// is in a module of its own, loaded when a body is first made; one source file sees its headers.
struct LevelSetModule {
  Result<void> (*unsignedDistances)(VoxelGrid& grid, const TriMesh& mesh, double voxel, int band);
  Result<TriMesh> (*zeroSurface)(const VoxelGrid& grid, double voxel);
};

/// What the module's constant is called.
inline constexpr const char* kLevelSetSymbol = "loricaLevelSet";

}  // namespace lorica
