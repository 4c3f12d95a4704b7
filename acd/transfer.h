#pragma once

#include "acd/decomposition.h"
#include "geometry/convex_hull.h"

#include <span>
#include <vector>

namespace lorica {

/// Carries the cut points to a pose (Eq. 10 to 12), in the order of their creation.
/// @param posed   vertexCount positions of the mesh in this pose [m]
/// @param points  pointCount positions; the first vertexCount are copied from `posed`, unless it is the same memory
void transfer(const Decomposition& decomposition, std::span<const Vec3> posed, std::span<Vec3> points);

/// The points of a part that are not blends of others of its points, ascending: their hull is the part's in every pose.
/// Blends arise where parts were cut and joined again.
[[nodiscard]] std::vector<PointIndex> spanningPoints(const Decomposition& decomposition, const Part& part);

/// Hull of one part in the pose held by `points` (pointCount positions).
[[nodiscard]] ConvexHull partHull(const Part& part, std::span<const Vec3> points);

/// Hulls of all parts, in part order.
[[nodiscard]] std::vector<ConvexHull> partHulls(const Decomposition& decomposition, std::span<const Vec3> points);

/// Sum of the parts' hull volumes over the mesh volume, less 1: (hullVolume - meshVolume) / meshVolume.
struct PoseError {
  double meshVolume = 0.0;  ///< [m^3]
  double hullVolume = 0.0;  ///< [m^3]
  [[nodiscard]] double relative() const { return (hullVolume - meshVolume) / meshVolume; }
};
[[nodiscard]] PoseError errorInPose(const Decomposition& decomposition, const TriMesh& mesh,
                                    std::span<const Vec3> posed);

}  // namespace lorica
