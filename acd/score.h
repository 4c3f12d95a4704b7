#pragma once

#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>

namespace lorica {

/// How well convex parts stand for a mesh: Thul et al. 2018, Eq. 16 to 18.
struct Score {
  double score16 = 0.0;               ///< intersection over union with overlaps counted again, by sampling
  double score16StandardError = 0.0;  ///< of that estimate
  double score17 = 0.0;               ///< mesh volume / sum of hull volumes
  double distance = 0.0;  ///< mean distance from the mesh's surface to the nearest hull's surface [mesh units]
  double distancePercentDiagonal = 0.0;
  double uncoveredFraction = 0.0;  ///< share of the mesh's volume that lies in no hull
};

struct ScoreSettings {
  int volumeSamples = 200000;
  int surfaceSamples = 20000;
  std::uint64_t seed = 1;
};

/// Judges any parts, ours or a rival's: the hull of each part's vertices is taken.
/// @return the score, or why the mesh was refused (not closed) or that there are no parts with volume
[[nodiscard]] Result<Score> score(const TriMesh& mesh, std::span<const TriMesh> parts, const ScoreSettings& settings);

}  // namespace lorica
