#pragma once

#include "acd/decomposition.h"
#include "geometry/convex_hull.h"

#include <span>
#include <vector>

namespace lorica {

/// Computes the cut points in a pose (Eq. 10 to 12), in order of creation.
/// @param posed   vertexCount positions of the mesh in this pose [m]
/// @param points  output, pointCount positions; the first vertexCount are copied from `posed`, unless it is the same
///                memory
void transfer(const Decomposition& decomposition, std::span<const Vec3> posed, std::span<Vec3> points);

/// Returns the points of a part that are not blends of other points of the part, ascending: their hull equals the
/// part's hull in every pose. Blends occur where parts were cut and merged again.
[[nodiscard]] std::vector<PointIndex> spanningPoints(const Decomposition& decomposition, const Part& part);

/// Hull of one part in the pose given by `points` (pointCount positions).
[[nodiscard]] ConvexHull partHull(const Part& part, std::span<const Vec3> points);

/// Hulls of all parts, in part order.
[[nodiscard]] std::vector<ConvexHull> partHulls(const Decomposition& decomposition, std::span<const Vec3> points);

/// Volume of the mesh and sum of the parts' hull volumes in one pose.
/// relative() = (hullVolume - meshVolume) / meshVolume.
struct PoseError {
  double meshVolume = 0.0;  ///< [m^3]
  double hullVolume = 0.0;  ///< [m^3]
  /// 0 = as tight as the mesh
  [[nodiscard]] double relative() const { return (hullVolume - meshVolume) / meshVolume; }
};
/// How much larger the hulls are than the mesh in one pose. @param posed  a position for each vertex [m].
[[nodiscard]] PoseError errorInPose(const Decomposition& decomposition, const TriMesh& mesh,
                                    std::span<const Vec3> posed);

}  // namespace lorica
