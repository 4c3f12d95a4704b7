#pragma once

#include "geometry/convex_hull.h"

#include <span>

namespace lorica::test {

/// How far the second must move along a unit direction to leave the first behind.
[[nodiscard]] double overlapAlong(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& direction);

/// Minimum depth of two convex polyhedra by brute force: over all face normals and all cross products of edges.
/// Negative if they are apart. A segment is a polyhedron with the triangle {0, 1, 1}.
[[nodiscard]] double slowDepth(const ConvexHull& a, const ConvexHull& b);

}  // namespace lorica::test
