#pragma once

#include "acd/decomposition.h"

#include <vector>

namespace lorica {

/// How close the first n parts of a decomposition are to the mesh, with the others joined to them.
struct DetailLevel {
  double meanError = 0.0;   ///< (hull volume - mesh volume) / mesh volume, mean over the keyframes
  double worstError = 0.0;  ///< that in the keyframe where it is largest
  int hullVertices = 0;     ///< of all hulls together, in the keyframe where they are most
};

/// The decomposition into fewer parts that a decomposition holds: its first parts, each with all those that were split
/// from it. Cut points keep their numbers, and a part loses the caps that two of its members shared. Where one member
/// was cut again across such a cap, its halves stay inside: they add no volume, and nothing to the hull.
/// @param partCount  1 to parts.size()
[[nodiscard]] Decomposition levelOfDetail(const Decomposition& decomposition, int partCount);

/// All levels of detail judged, without joining their triangles: entry n - 1 is of n parts, the last one of all.
/// @param keyframes  positions [m], keyframeCount x vertexCount, keyframe-major, at least one
[[nodiscard]] std::vector<DetailLevel> detailLadder(const Decomposition& decomposition, const TriMesh& mesh,
                                                    PoseView keyframes);

}  // namespace lorica
