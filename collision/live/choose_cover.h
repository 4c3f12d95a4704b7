#pragma once

#include "acd/hull_cover.h"
#include "collision/live/lifted_point.h"

#include <functional>
#include <span>
#include <vector>

namespace lorica {

/// Bones of a character in several poses, borrowed: poseCount x jointCount transforms worldFromModel, pose-major.
struct BonePoseView {
  std::span<const Affine3> worldFromModel;
  int jointCount = 0;

  [[nodiscard]] int poseCount() const {
    return jointCount == 0 ? 0 : static_cast<int>(worldFromModel.size()) / jointCount;
  }
  [[nodiscard]] std::span<const Affine3> pose(int p) const {
    return worldFromModel.subspan(static_cast<std::size_t>(p) * static_cast<std::size_t>(jointCount),
                                  static_cast<std::size_t>(jointCount));
  }
};

struct CoverSettings {
  double tolerance = 0.0;   ///< what may stick out of the chosen points' hulls before they grow [m]; 0 = nothing
  int maxHullVertices = 0;  ///< points of each part at most, whatever sticks out; 0 = no bound, else 4 or more
  int threads = 0;          ///< 0 = as many as the machine has; the result does not depend on it
  std::function<bool(int partsDone, int parts)> progress = {};  ///< one call at a time; return false to cancel
};

/// Every point that can be on a hull: the surface is inside the hulls in every pose, by construction, and so is every
/// vertex that people see beside it, passengersOf().
[[nodiscard]] CoverPromise coverExactly(const Decomposition& decomposition, std::span<const LiftedPoint> lifted);

/// Few points of each part, whose hulls, grown a little, hold the surface in all sampled poses.
///
/// Always the point that sticks out farthest in any sampled pose is taken next. Then points are pushed until in no
/// sampled pose anything sticks out. A push turns with the bones as the surface does and is part of the lifted point,
/// so growing costs a frame nothing. Held-out poses only measure.
/// @param decomposition  made from a character's mesh
/// @param lifted         its points, liftPoints()
/// @param sampled        1 pose or more
/// @param heldOut        may be none
/// @return the promise, or that a setting is wrong (kInvalidArgument), or kCancelled
[[nodiscard]] Result<CoverPromise> chooseCover(const Decomposition& decomposition, std::span<const LiftedPoint> lifted,
                                               BonePoseView sampled, BonePoseView heldOut,
                                               const CoverSettings& settings);

/// A lifted point pushed outward: the push turns with the bones as the surface does.
[[nodiscard]] LiftedPoint pushed(LiftedPoint point, const Vec3& outward);

}  // namespace lorica
