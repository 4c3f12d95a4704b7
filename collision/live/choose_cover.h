#pragma once

#include "acd/hull_cover.h"
#include "collision/live/lifted_point.h"
#include "geometry/counts.h"

#include <functional>
#include <span>

namespace lorica {

/// Bones of a character in several poses, not owned: poseCount x jointCount transforms worldFromModel, pose-major.
struct BonePoseView {
  std::span<const Affine3> worldFromModel;  ///< poseCount x jointCount, pose-major
  int jointCount = 0;                       ///< of the skeleton

  /// 0 without joints
  [[nodiscard]] int poseCount() const { return jointCount == 0 ? 0 : countOf(worldFromModel) / jointCount; }
  /// The bones in pose `p`.
  [[nodiscard]] std::span<const Affine3> pose(int p) const {
    return worldFromModel.subspan(static_cast<std::size_t>(p) * jointCount, jointCount);
  }
};

/// How many points the hulls may have, and how closely they follow the surface.
struct CoverSettings {
  double tolerance = 0.0;  ///< max protrusion from the chosen points' hulls before they are enlarged [m]; 0 = exact
  /// Max points per part, which takes precedence over the tolerance; 0 = no limit, else 4 or more.
  int maxHullVertices = 0;
  int threads = 0;  ///< 0 = as many as the machine has; the result does not depend on it
  /// Called by one thread at a time; return false to cancel.
  std::function<bool(int partsDone, int parts)> progress = {};
};

/// Uses every point that can be on a hull. By construction the surface is inside the hulls in every pose, and so is
/// every visible vertex outside the parts, attachedVerticesOf().
[[nodiscard]] HullCover coverExactly(const Decomposition& decomposition, std::span<const LiftedPoint> lifted);

/// Chooses few points of each part, whose slightly enlarged hulls cover the surface in all sampled poses.
///
/// First, points are added one by one: always the one that protrudes farthest in any sampled pose. Then points are
/// pushed outward until nothing protrudes in any sampled pose. A push rotates with the bones as the surface does and is
/// part of the lifted point, so enlarging costs nothing per frame. Held-out poses are only measured.
/// @param decomposition  made from a character's mesh
/// @param lifted         its points, liftPoints()
/// @param sampled        1 pose or more
/// @param heldOut        may be empty
/// @return the hull cover, or an error if a setting is wrong (kInvalidArgument), or kCancelled
[[nodiscard]] Result<HullCover> chooseCover(const Decomposition& decomposition, std::span<const LiftedPoint> lifted,
                                            BonePoseView sampled, BonePoseView heldOut, const CoverSettings& settings);

/// A lifted point pushed outward: the push rotates with the bones as the surface does.
[[nodiscard]] LiftedPoint pushed(LiftedPoint point, const Vec3& outward);

}  // namespace lorica
