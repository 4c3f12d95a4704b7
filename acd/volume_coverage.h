#pragma once

#include "geometry/convex_hull.h"

#include <cstdint>
#include <span>

namespace lorica {

/// Share of a closed mesh's inside that lies in at least one of some hulls. Internal to score().
struct Coverage {
  double fraction = 0.0;       ///< 0 to 1
  double standardError = 0.0;  ///< from the spread of independent estimates
};

/// Estimates the coverage by lines along z, one at random in each cell of a grid over the mesh's bounds. Along a line
/// the lengths inside the mesh and inside any hull are exact: only the choice of lines is random.
/// @param mesh   closed; inside is where its winding number is positive
/// @param lines  in all, at least 16
[[nodiscard]] Coverage estimateCoverage(const TriMesh& mesh, std::span<const ConvexHull> hulls, int lines,
                                        std::uint64_t seed);

}  // namespace lorica
