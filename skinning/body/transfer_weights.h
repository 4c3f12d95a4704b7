#pragma once

#include "skinning/body/solid_surface.h"

#include <vector>

namespace lorica {

/// Influences for the vertices of a surface that was made about another one.
///
/// Each vertex takes those at the nearest point of the original that faces the same way, blended from the corners
/// there. Where most neighbours follow another limb it takes them from that limb instead. Then they are smoothed over
/// the surface; smoothing brings in no bone of another limb.
/// @param body   closed, in the original's bind pose
/// @param voxel  edge of the voxels that the body was made with [m]
/// @return for each vertex at most 8 influences that sum to 1
[[nodiscard]] std::vector<std::vector<Influence>> carryWeights(const TriMesh& body, const SolidSource& source,
                                                               double voxel);

}  // namespace lorica
