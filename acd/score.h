#pragma once

#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>

namespace lorica {

/// Of evenly spread points [mesh units].
struct Distances {
  double mean = 0.0;
  double most = 0.0;  ///< 95 % of the points are at most this far
  double largest = 0.0;
};

/// How well convex parts approximate a mesh: Thul et al. 2018, Eq. 16 to 18.
///
/// The volumes of the mesh (signed volume) and of the hulls are exact. Only the fraction of the mesh that is covered by
/// the hulls is estimated; see ScoreSettings::volumeSamples.
struct Score {
  double score16 = 0.0;               ///< covered / (uncovered + sum of hull volumes): 1 is perfect
  double score16StandardError = 0.0;  ///< of this estimate; 0 up to rounding if the hulls cover the mesh
  double score17 = 0.0;               ///< mesh volume / sum of hull volumes: equals score16 if the hulls cover the mesh
  double distance = 0.0;  ///< mean distance from the mesh's surface to the nearest hull's surface [mesh units]
  double distancePercentDiagonal = 0.0;  ///< the same in percent of the diagonal of the mesh's bounds
  double uncoveredFraction = 0.0;        ///< fraction of the mesh's volume that is in no hull

  Distances toHulls;    ///< from the surface to the nearest hull's surface; its mean is `distance`
  Distances toSurface;  ///< from the hulls to the surface, where they are in neither the mesh nor another hull
  /// CoACD's concavity of what each hull holds of the mesh, see hullConcavity(), in concavityUnit().
  double concavity = 0.0;      ///< largest of all hulls
  double meanConcavity = 0.0;  ///< over the hulls
};

struct ScoreSettings {
  /// Number of lines through the mesh, at random positions in the cells of a grid; the covered length of each line is
  /// exact. At least 16. Rounded down to 16 independent square grids, whose variation gives the standard error.
  int volumeSamples = 200000;
  /// Points on the mesh's surface, one in each of equally many strips of equal area; at least 1.
  int surfaceSamples = 20000;
  int concavitySamples = 2000;  ///< on each hull and on its part of the surface; at least 1
  std::uint64_t seed = 1;       ///< the same seed gives the same score on every machine
};

/// Scores parts from any source, using the convex hull of each part's vertices.
///
/// Eq. 18 is interpreted as the distance to a hull's *surface*, from inside or outside: the paper uses an absolute
/// distance and reports more than 0 for hulls that contain the whole mesh. A flat part adds no volume, but its
/// triangles count as surface. Where a mesh overlaps itself, volume counts once.
/// @param surface  to which distances are measured, where that is not the mesh's own: of a file that was repaired
/// @return the score, or an error: mesh not closed or overlapping in a way that cannot be resolved, part not finite,
/// invalid settings, or no part with volume
[[nodiscard]] Result<Score> score(const TriMesh& mesh, std::span<const TriMesh> parts, const ScoreSettings& settings,
                                  const TriMesh* surface = nullptr);

}  // namespace lorica
