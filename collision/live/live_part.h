#pragma once

#include "geometry/convex_hull.h"
#include "geometry/math.h"

#include <vector>

namespace lorica {

/// One part of the avatar in the current frame, as physics and pictures see it.
///
/// A part has a frame of its own, which follows the best-fit rigid motion of its points and has its origin at their
/// mean. Worn this way, the body of physics carries what is rigid in the motion, with its velocity, and only what is
/// left goes into the shape.
struct LivePart {
  /// In the part's own frame [m]; pointOfVertex are points of the decomposition. No triangles while the part is flat.
  ConvexHull shape;
  Isometry3 worldFromPart = Isometry3::Identity();
  Isometry3 previousWorldFromPart = Isometry3::Identity();  ///< one frame ago; in the first frame, the same
  bool reshaped = true;                                     ///< the shape is not the one of the frame before
  /// 0 to 1: how far the part can be believed to be where it is. Whoever is not believed strikes nothing, see World.
  double trust = 1.0;
  std::vector<Vec3> previousVertices;  ///< of the shape one frame ago, where `reshaped`; empty in the first frame
};

/// The part's hull in world space.
[[nodiscard]] ConvexHull worldHull(const LivePart& part);

/// Velocity of the part's material at a place, from its rigid motion since the last frame [m/s].
/// @param point    world [m]
/// @param seconds  since the last frame, above 0
[[nodiscard]] Vec3 velocityAt(const LivePart& part, const Vec3& point, double seconds);

/// Hull of where the part was one frame ago and where it is now, in world space: all that it swept, were its motion
/// straight. A turn by an angle leaves it by up to 1 - cos(angle / 2) of the radius.
[[nodiscard]] ConvexHull sweptHull(const LivePart& part);

}  // namespace lorica
