#pragma once

#include "collision/live/choose_cover.h"
#include "export/rigid_colliders.h"
#include "skinning/character.h"

#include <functional>
#include <span>

namespace lorica {

/// How far colliders are from the skin, over several poses.
struct ColliderFit {
  double worstOut = 0.0;       ///< farthest that a vertex of the skin sticks out of all colliders [m]
  double meanWorstOut = 0.0;   ///< the same in each pose, mean over the poses [m]
  double shareOut = 0.0;       ///< vertices that stick out by more than a millimetre, of all
  double worstStandOff = 0.0;  ///< farthest that a collider's surface stands off outside the skin [m]
  double meanStandOff = 0.0;   ///< mean over the surface of all colliders that is outside the others; inside the skin 0
  double volume = 0.0;         ///< sum over the colliders [m^3]
};

struct ColliderFits {
  ColliderFit hulls, capsules;
};

/// Measures hulls and the capsules around the same surface. Distances to the skin are exact at the skin's vertices and
/// at 64 points of each collider, spread evenly by area. Bones should keep their size.
/// @param poses     worldFromModel, at least one
/// @param progress  false = stop
/// @return the figures, or that it was stopped
[[nodiscard]] Result<ColliderFits> measureFit(const Character& character, std::span<const RigidCollider> colliders,
                                              BonePoseView poses, int threads,
                                              const std::function<bool(int done, int poses)>& progress = {});

}  // namespace lorica
