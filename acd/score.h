#pragma once

#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>

namespace lorica {

/// How well convex parts stand for a mesh: Thul et al. 2018, Eq. 16 to 18.
///
/// The mesh's volume is its signed volume, and a hull's is that of the hull: both exact. What must be estimated is only
/// the share of the mesh that the hulls cover; see ScoreSettings::volumeSamples.
struct Score {
  double score16 = 0.0;               ///< covered / (uncovered + sum of hull volumes): 1 is perfect
  double score16StandardError = 0.0;  ///< of that estimate; 0 but for rounding where the hulls cover all
  double score17 = 0.0;               ///< mesh volume / sum of hull volumes: equals Eq. 16 where the hulls cover all
  double distance = 0.0;  ///< mean distance from the mesh's surface to the nearest hull's surface [mesh units]
  double distancePercentDiagonal = 0.0;  ///< that, in percent of the diagonal of the mesh's bounds
  double uncoveredFraction = 0.0;        ///< share of the mesh's volume that lies in no hull
};

struct ScoreSettings {
  /// Lines through the mesh, at random in the cells of a grid, of which the covered length is found exactly; at
  /// least 16. Rounded down to 16 independent square grids, whose spread gives the standard error.
  int volumeSamples = 200000;
  int surfaceSamples =
      20000;               ///< points on the mesh's surface, one in each of as many strips of equal area; at least 1
  std::uint64_t seed = 1;  ///< same seed, same score on every machine
};

/// Judges any parts, ours or a rival's: the hull of each part's vertices is taken.
///
/// Eq. 18 is read as the distance to a hull's *surface*, from inside as from outside: the paper speaks of an absolute
/// distance and reports more than 0 for hulls that contain the whole mesh. A flat part adds no volume, but its
/// triangles count as surface. Where a mesh overlaps itself, the overlap counts once as covered or not, but twice in
/// its volume.
/// @return the score, or why the mesh was refused (not closed), a part (not finite), the settings, or that there are no
///         parts with volume
[[nodiscard]] Result<Score> score(const TriMesh& mesh, std::span<const TriMesh> parts, const ScoreSettings& settings);

}  // namespace lorica
