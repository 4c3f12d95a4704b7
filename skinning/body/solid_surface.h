#pragma once

#include "geometry/result.h"
#include "skinning/body/solid_source.h"

#include <cstddef>

namespace lorica {

struct SolidSurface {
  TriMesh mesh;  ///< closed two-manifold; may be of several pieces that are apart
  std::size_t pieces = 0;
  std::size_t droppedPieces = 0;   ///< too small to count
  std::size_t enclosedVoxels = 0;  ///< that no way from outside leads to, though nothing winds round them
  std::size_t partedVoxels = 0;    ///< taken out where limbs touch
  std::size_t thinVoxels = 0;      ///< taken out where less than a voxel is solid
  std::size_t rodTriangles = 0;    ///< of limbs too thin for the voxels, which were made as thick as these need
};

/// The surface of what is inside of triangles that need not close.
///
/// On a grid: a point is inside where the triangles wind round it more than half a time, or where no way from outside
/// leads to it. Distances to the triangles (OpenVDB) place the surface between the grid's points, so where the
/// triangles are whole it lies on them; holes are closed where the winding number is a half. Left out is what is
/// thinner than a voxel; limbs that touch are kept apart where they are less than a voxel into each other.
/// @param voxel  edge [m]
/// @return the surface; kBadMesh when nothing is enclosed, kInvalidArgument when the voxels would be too many
[[nodiscard]] Result<SolidSurface> solidSurface(const SolidSource& source, double voxel);

}  // namespace lorica
