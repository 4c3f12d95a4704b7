#pragma once

#include "geometry/convex_hull.h"

#include <span>

namespace lorica {

/// Largest distance from any point of a part's hull surface to the part's own surface [m].
///
/// Caps lie inside the mesh, so for the points of the hull that stick out of the mesh this bounds their distance to the
/// mesh as well. A void that the hull closes off without touching, such as a bubble, is not seen: the hull's surface is
/// not in it.
///
/// Distance grows by at most a metre for each metre walked, and to a single triangle it is convex: both bound it over a
/// piece of the hull from above. The piece with the highest bound is halved until that bound is close enough.
/// @param points       positions that the triangles index
/// @param triangles    of the closed part, at least one; the hull is that of their corners
/// @param ignoreBelow  distances up to this are all the same to the caller [m]; raised to 0.1 % of the hull's diagonal
/// @return a value from the true distance to max(1.01 times it, ignoreBelow); 0 for a degenerate hull
[[nodiscard]] double hullDistance(const ConvexHull& hull, std::span<const Vec3> points,
                                  std::span<const Triangle> triangles, double ignoreBelow);

}  // namespace lorica
