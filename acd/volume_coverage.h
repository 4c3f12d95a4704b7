#pragma once

#include "geometry/convex_hull.h"

#include <cstdint>
#include <span>

namespace lorica {

/// Fraction of a closed mesh's volume that is inside at least one hull. Internal to score().
struct Coverage {
  double fraction = 0.0;       ///< 0 to 1
  double standardError = 0.0;  ///< from the variation of independent estimates
};

/// Estimates the coverage by lines along z, one at a random position in each cell of a grid over the mesh's bounds.
/// Along a line the lengths inside the mesh and inside any hull are exact: only the choice of lines is random.
/// @param mesh   closed; a point with positive winding number is inside
/// @param lines  total number, at least 16
[[nodiscard]] Coverage estimateCoverage(const TriMesh& mesh, std::span<const ConvexHull> hulls, int lines,
                                        std::uint64_t seed);

/// Volume that a closed mesh and a hull have in common, estimated by lines in the same way [m^3].
[[nodiscard]] double commonVolume(const TriMesh& mesh, const ConvexHull& hull, int lines, std::uint64_t seed);

}  // namespace lorica
