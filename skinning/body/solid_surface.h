#pragma once

#include "geometry/result.h"
#include "skinning/body/solid_source.h"

#include <cstddef>

namespace lorica {

struct SolidSurface {
  TriMesh mesh;  ///< closed two-manifold; may consist of several separate pieces
  std::size_t pieces = 0;
  std::size_t droppedPieces = 0;   ///< too small to keep
  std::size_t enclosedVoxels = 0;  ///< not reachable from outside although their winding number is at most 0.5
  std::size_t partedVoxels = 0;    ///< removed where limbs touch
  std::size_t thinVoxels = 0;      ///< removed where geometry is thinner than a voxel
  std::size_t rodTriangles = 0;    ///< of limbs too thin for the voxels, which were thickened
};

/// The finest voxels of which solidSurface() takes a mesh, a little coarser [m].
[[nodiscard]] double finestVoxel(const TriMesh& mesh);

/// The surface of the volume that triangles enclose; they need not form a closed surface.
///
/// On a grid: a point is inside if its winding number is above 0.5, or if it cannot be reached from outside. Distances
/// to the triangles (OpenVDB) position the surface between the grid's points, so that it follows the triangles where
/// there are any; holes are closed where the winding number is 0.5. Geometry thinner than a voxel is left out; limbs
/// that touch are kept separate where they overlap by less than a voxel.
/// @param voxel     edge [m]
/// @param keepThin  see BodySettings
/// @return the surface; kBadMesh if nothing is enclosed, kInvalidArgument if there would be too many voxels
[[nodiscard]] Result<SolidSurface> solidSurface(const SolidSource& source, double voxel, bool keepThin);

}  // namespace lorica
