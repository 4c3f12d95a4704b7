#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "prepare/cover_poses.h"
#include "skinning/character.h"

#include <functional>
#include <optional>

namespace lorica {

/// Requirements on the hulls of a character's live body.
struct CoverRequest {
  std::optional<double> tolerance;  ///< [m]; 0 = exact
  int hullVertices = 0;             ///< maximum for each hull; 0 = no limit

  [[nodiscard]] bool given() const { return tolerance.has_value() || hullVertices > 0; }
  /// Whether every point is kept, so that nothing has to be chosen.
  [[nodiscard]] bool exact() const { return tolerance.value_or(0.0) == 0.0 && hullVertices == 0; }
};

/// chooseCover() for a character.
/// @param decomposition  made from the character's mesh
/// @param threads        0 = as many as the machine has; the result does not depend on it
/// @param progress       one call at a time; return false to cancel
[[nodiscard]] Result<HullCover> chooseCover(const Character& character, const Decomposition& decomposition,
                                            const CoverPoses& poses, const CoverRequest& request, int threads,
                                            const std::function<bool(int partsDone, int parts)>& progress = {});

/// Extra volume of a cover's hulls relative to exact ones (0.05 is 5 %), over all parts and every fourth sampled pose.
[[nodiscard]] double volumeGrowth(const Character& character, const Decomposition& decomposition,
                                  const CoverPoses& poses, const HullCover& cover);

}  // namespace lorica
