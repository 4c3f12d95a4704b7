#pragma once

#include "skinning/body/solid_surface.h"

#include <vector>

namespace lorica {

/// The strongest 8 of influences that are at least 0.2 %; they sum to 1.
[[nodiscard]] std::vector<Influence> pruned(std::vector<Influence> weights);

/// Transfers influences to the vertices of a surface that was built around another one.
///
/// Each vertex gets those of the nearest point of the original that faces the same way, interpolated from the corners
/// of its triangle. If most neighbours follow another limb, it gets them from that limb instead. Then they are smoothed
/// over the surface; smoothing adds no bone of another limb.
/// @param body   closed, in the original's bind pose
/// @param voxel  edge of the voxels that the body was built with [m]
/// @return at most 8 influences per vertex, which sum to 1
[[nodiscard]] std::vector<std::vector<Influence>> transferWeights(const TriMesh& body, const SolidSource& source,
                                                                  double voxel);

}  // namespace lorica
