#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "prepare/cover_poses.h"
#include "skinning/character.h"

#include <optional>

namespace lorica {

/// How closely live hulls fit a body in poses that its parts were not trained on.
struct HeldOutError {
  double error = 0.0;  ///< mean of (hull volume - body volume) / body volume
  int poses = 0;
};

/// Measures it in every fourth held-out pose: half of them from the motions, half random within joint limits.
/// @param cover  none = exact
[[nodiscard]] HeldOutError heldOutError(const Character& character, const Decomposition& decomposition,
                                        const std::optional<HullCover>& cover, const CoverPoses& poses);

}  // namespace lorica
