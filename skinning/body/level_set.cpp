#include "skinning/body/level_set.h"

#include "geometry/module.h"

namespace lorica {
namespace {

Result<const LevelSetModule*> levelSets() {
  LORICA_TRY(const void* module, loadModule("level_set", kLevelSetSymbol, "a closed body for an open mesh"));
  return static_cast<const LevelSetModule*>(module);
}

}  // namespace

Result<void> unsignedDistances(VoxelGrid& grid, const TriMesh& mesh, double voxel, int band) {
  LORICA_TRY(const LevelSetModule* module, levelSets());
  return module->unsignedDistances(grid, mesh, voxel, band);
}

Result<TriMesh> zeroSurface(const VoxelGrid& grid, double voxel) {
  LORICA_TRY(const LevelSetModule* module, levelSets());
  return module->zeroSurface(grid, voxel);
}

}  // namespace lorica
