#pragma once

#include "geometry/convex_hull.h"
#include "geometry/math.h"

#include <vector>

namespace lorica {

/// One part of the avatar in the current frame, for physics and rendering.
///
/// A part has its own frame, which follows the best-fit rigid motion of its points and has its origin at their mean.
/// The physics body therefore takes the rigid share of the motion, with its velocity, and only the rest changes the
/// shape.
struct LivePart {
  /// In the part's own frame [m]; pointOfVertex refers to points of the decomposition. No triangles while the part is
  /// flat.
  ConvexHull shape;
  double radius = 0.0;  ///< greatest distance of a vertex of the shape from the part's origin [m]
  Isometry3 worldFromPart = Isometry3::Identity();          ///< rigid motion of the part in this frame [m]
  Isometry3 previousWorldFromPart = Isometry3::Identity();  ///< one frame ago; in the first frame, the same
  bool reshaped = true;                                     ///< the shape differs from the previous frame's
  /// 0 to 1: how certain the part's pose is. A part that is not trusted strikes nothing, see World.
  double trust = 1.0;
  std::vector<Vec3> previousVertices;  ///< of the shape one frame ago, if `reshaped`; empty in the first frame
};

/// The part's hull in world space.
[[nodiscard]] ConvexHull worldHull(const LivePart& part);
/// The same in a hull of the caller's, whose memory is reused.
void worldHull(const LivePart& part, ConvexHull& hull);

/// Velocity of the part's material at a point, from its rigid motion since the last frame [m/s].
/// @param point    world [m]
/// @param seconds  since the last frame, above 0
[[nodiscard]] Vec3 velocityAt(const LivePart& part, const Vec3& point, double seconds);

/// Velocity of a part's own frame, from its rigid motion since the last one.
struct PartVelocity {
  Vec3 linear = Vec3::Zero();   ///< of its origin [m/s]
  Vec3 angular = Vec3::Zero();  ///< about world axes [rad/s]; the turn since the last frame, by less than half a circle
};
/// @param seconds  since the last frame, above 0
[[nodiscard]] PartVelocity velocityOf(const LivePart& part, double seconds);

/// Hull of the part's positions one frame ago and now, in world space: the volume swept by a straight motion. Rotation
/// by an angle leaves it by up to 1 - cos(angle / 2) of the radius.
[[nodiscard]] ConvexHull sweptHull(const LivePart& part);
/// The points whose hull that is: the vertices of the present shape, then those of one frame ago, in world space [m].
/// Allocates only what `points` lacks: at most twice LiveBody::candidateCount().
void sweptPoints(const LivePart& part, std::vector<Vec3>& points);

}  // namespace lorica
