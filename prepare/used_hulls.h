#pragma once

#include "acd/hull_cover.h"
#include "collision/live/choose_cover.h"
#include "geometry/convex_hull.h"
#include "skinning/character.h"

#include <vector>

namespace lorica {

/// The hulls that are used, for figures about them: one list of the parts' hulls for each pose.
using UsedHulls = std::vector<std::vector<ConvexHull>>;

/// The hulls that a live body of this cover has in some poses of its bones.
[[nodiscard]] UsedHulls liveHulls(const Character& character, const Decomposition& decomposition,
                                  const HullCover& cover, BonePoseView poses);

}  // namespace lorica
