#pragma once

#include "geometry/convex_hull.h"

namespace lorica {

/// Encloses a body in few half-spaces. Progressive convex hull simplification (Jacobson 2026, arXiv 2604.14468): of the
/// planes of its faces, the one whose loss adds the least volume is dropped, again and again. Then, unlike there, each
/// plane that is left is turned about the body as long as the volume falls. Internal: not installed.
/// @param body         with the origin well inside and extents of the order of 1
/// @param maxPlanes    at least 4
/// @param maxVertices  of what is returned; 0 = no limit
/// @param turned       whether planes are turned
/// @return the polyhedron, to within rounding; degenerate if none was found
[[nodiscard]] ConvexHull fewerPlanes(const ConvexHull& body, int maxPlanes, int maxVertices, bool turned);

/// The number of planes that bound a body: coplanar triangles count once, slivers not at all. Internal: not installed.
/// @param body  as for fewerPlanes()
[[nodiscard]] int planesOf(const ConvexHull& body);

}  // namespace lorica
