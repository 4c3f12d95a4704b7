#include "skinning/body/level_set.h"

#include "geometry/module.h"
#include "skinning/body/level_set_module.h"

namespace lorica {
namespace {

Result<const LevelSetModule*> levelSets() {
  const Result<const void*> module = loadModule("level_set", kLevelSetSymbol, "a closed body for an open mesh");
  if (!module) return module.error();
  return static_cast<const LevelSetModule*>(*module);
}

}  // namespace

Result<void> unsignedDistances(VoxelGrid& grid, const TriMesh& mesh, double voxel, int band) {
  const Result<const LevelSetModule*> module = levelSets();
  if (!module) return module.error();
  return (*module)->unsignedDistances(grid, mesh, voxel, band);
}

Result<TriMesh> zeroSurface(const VoxelGrid& grid, double voxel) {
  const Result<const LevelSetModule*> module = levelSets();
  if (!module) return module.error();
  return (*module)->zeroSurface(grid, voxel);
}

}  // namespace lorica
