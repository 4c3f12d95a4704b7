#pragma once

#include "acd/decomposition.h"
#include "geometry/convex_hull.h"

#include <span>
#include <vector>

namespace lorica {

/// How closely the first n parts of a decomposition, with the other parts merged into them, fit the mesh.
struct DetailLevel {
  double meanError = 0.0;   ///< (hull volume - mesh volume) / mesh volume, mean over the keyframes
  double worstError = 0.0;  ///< maximum over the keyframes
  int hullVertices = 0;     ///< sum over all hulls, maximum over the keyframes
};

/// Returns the decomposition at a coarser level of detail: the first `partCount` parts, each merged with all parts that
/// were split from it. Cut points keep their indices. Caps shared by two merged parts are removed, unless a part was
/// cut again across the cap: then caps stay inside the merged part. They add no volume and do not change the hull.
/// @param partCount  1 to parts.size()
[[nodiscard]] Decomposition levelOfDetail(const Decomposition& decomposition, int partCount);

/// The hulls of all parts, one list for each keyframe.
[[nodiscard]] std::vector<std::vector<ConvexHull>> hullsOfParts(const Decomposition& decomposition, PoseView keyframes);

/// Evaluates all levels of detail, without merging triangles: entry n - 1 is for n parts, the last one for all parts.
/// @param keyframes  positions [m], keyframeCount x vertexCount, keyframe-major, at least one
/// @param hulls      hullsOfParts(), or larger ones that are used in their place
[[nodiscard]] std::vector<DetailLevel> detailLevels(const Decomposition& decomposition, const TriMesh& mesh,
                                                    PoseView keyframes, std::span<const std::vector<ConvexHull>> hulls);

}  // namespace lorica
