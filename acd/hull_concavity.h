#pragma once

#include "geometry/convex_hull.h"
#include "geometry/triangle_tree.h"

#include <cstdint>

namespace lorica {

/// The surface of a solid that lies in a hull. Internal to score().
[[nodiscard]] TriMesh clippedToHull(const TriMesh& solid, const ConvexHull& hull);

/// How concave the part of a solid in a hull is, as CoACD measures it, see partConcavity(), whichever program made the
/// hull. The part is the intersection of solid and hull. So where the hull's surface is in the solid, both have the
/// same surface.
/// @param solid  closed
/// @param tree   of its triangles
/// @param samples  points on each of both surfaces
/// @return [m]; 0 for a degenerate hull
[[nodiscard]] double hullConcavity(const TriMesh& solid, const TriangleTree& tree, const ConvexHull& hull, int samples,
                                   std::uint64_t seed);

}  // namespace lorica
