#pragma once

#include "geometry/convex_hull.h"

#include <span>

namespace lorica {

/// Returns the largest distance from any point of a part's hull surface to the part's surface [m].
///
/// Caps are inside the mesh, so for points of the hull outside the mesh this also bounds their distance to the mesh.
/// An internal cavity that the hull does not touch, such as a bubble, is ignored: the hull's surface is not in it.
///
/// The distance is Lipschitz continuous with constant 1, and the distance to a single triangle is convex. Both give
/// upper bounds over a piece of the hull, a triangle or a flat face of many. The piece with the highest bound is halved
/// until the bound is within the tolerance.
/// @param points       positions that the triangles index
/// @param triangles    of the closed part, at least one; the hull contains them
/// @param ignoreBelow  distances up to this need not be distinguished [m]; raised to 0.1 % of the hull's diagonal
/// @param enough       nor distances above this [m]
/// @return a value between the true distance and max(1.01 * true distance, ignoreBelow), or one above
///         `enough` that is at most the true distance; 0 for a degenerate hull
[[nodiscard]] double hullDistance(const ConvexHull& hull, std::span<const Vec3> points,
                                  std::span<const Triangle> triangles, double ignoreBelow, double enough = kInfinity);

}  // namespace lorica
