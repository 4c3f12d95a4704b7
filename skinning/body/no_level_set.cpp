// Of the core alone (LORICA_CORE), which does without OpenVDB.
#include "geometry/errors.h"
#include "skinning/body/level_set.h"

namespace lorica {
namespace {

Error without() {
  return unsupported(
      "it is open, and this build of Lorica has no OpenVDB to make a closed body: close it, choose walls \"shell\", "
      "or make its .lorica file with the command");
}

}  // namespace

Result<void> unsignedDistances(VoxelGrid& /*grid*/, const TriMesh& /*mesh*/, double /*voxel*/, int /*band*/) {
  return without();
}

Result<TriMesh> zeroSurface(const VoxelGrid& /*grid*/, double /*voxel*/) {
  return without();
}

}  // namespace lorica
