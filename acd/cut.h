#pragma once

#include "acd/decomposition.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// The plane normal . x = offset; a point is above it if normal . x > offset.
struct Plane {
  Vec3 normal;
  double offset = 0.0;
};

/// Cuts off what of a convex polygon is above a plane.
/// @param scratch  kept from call to call
void keepBelow(std::vector<Vec3>& polygon, const Plane& plane, std::vector<Vec3>& scratch);

/// Sides of a plane on which the points of a part are: -1 below, 0 on it, 1 above. Candidate planes always contain
/// vertices of the mesh, so "on the plane" is a separate state; such vertices belong to the caps of both sides.
class PlaneSides {
 public:
  /// @param points     all points in the keyframe of the plane, indexed by PointIndex
  /// @param tolerance  points up to this distance count as on the plane [m]
  void classify(const Part& part, std::span<const Vec3> points, const Plane& plane, double tolerance);

  /// Classifies one point and returns its side.
  int classify(PointIndex p, std::span<const Vec3> points, const Plane& plane, double tolerance);

  [[nodiscard]] int sideOf(PointIndex p) const { return side_[p]; }
  [[nodiscard]] double distanceOf(PointIndex p) const { return distance_[p]; }
  /// The intersection of the plane and the edge between two points on opposite sides (Eq. 10).
  [[nodiscard]] CutPoint crossing(PointIndex a, PointIndex b) const;
  /// The side of a triangle that does not cross the plane. A triangle in the plane belongs to the side of the solid; 0
  /// if it is thinner than the tolerance, so that its normal does not tell which side that is.
  [[nodiscard]] int sideOf(const Triangle& triangle, std::span<const Vec3> points, const Plane& plane,
                           double tolerance) const;

 private:
  std::vector<std::int8_t> side_;
  std::vector<double> distance_;
};

/// The two closed halves of a part.
struct CutResult {
  Part above;
  Part below;
  std::vector<CutPoint> newPoints;  ///< numbered from `firstNewPoint`
};

/// Cuts a part and closes both halves with the same cap, reversed for one of them.
/// @param firstNewPoint  PointIndex of the first new point
[[nodiscard]] CutResult cutPart(const Part& part, std::span<const Vec3> points, const Plane& plane, double tolerance,
                                PointIndex firstNewPoint);

/// Returns the points that the triangles use, ascending, for Part::points.
[[nodiscard]] std::vector<PointIndex> pointsUsedBy(std::span<const Triangle> triangles);

}  // namespace lorica
