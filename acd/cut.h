#pragma once

#include "acd/decomposition.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// normal . x = offset; `above` is where normal . x > offset.
struct Plane {
  Vec3 normal;
  double offset = 0.0;
};

/// Where the points of a part lie with respect to a plane: -1 below, 0 on it, 1 above. Candidate planes always contain
/// vertices of the mesh, so "on" is a state of its own and such vertices belong to both sides' caps.
class PlaneSides {
 public:
  /// @param points     all points in the keyframe where the plane is, indexed by PointIndex
  /// @param tolerance  distance up to which a point counts as on the plane [m]
  void classify(const Part& part, std::span<const Vec3> points, const Plane& plane, double tolerance);

  /// The same for one point; returns its side.
  int classify(PointIndex p, std::span<const Vec3> points, const Plane& plane, double tolerance);

  [[nodiscard]] int sideOf(PointIndex p) const { return side_[static_cast<std::size_t>(p)]; }
  [[nodiscard]] double distanceOf(PointIndex p) const { return distance_[static_cast<std::size_t>(p)]; }
  /// The point where the edge between two points on opposite sides meets the plane (Eq. 10).
  [[nodiscard]] CutPoint crossing(PointIndex a, PointIndex b) const;
  /// The side of a triangle that does not cross the plane; one lying in it belongs to where the solid is.
  [[nodiscard]] int sideOf(const Triangle& triangle, std::span<const Vec3> points, const Plane& plane) const;

 private:
  std::vector<std::int8_t> side_;
  std::vector<double> distance_;
};

/// The two closed halves of a part.
struct CutResult {
  Part above;
  Part below;
  std::vector<CutPoint> newPoints;  ///< numbered from `firstNewPoint` on
};

/// Cuts a part and closes both halves with one cap, reversed on one of them.
/// @param firstNewPoint  PointIndex of the first new point
[[nodiscard]] CutResult cutPart(const Part& part, std::span<const Vec3> points, const Plane& plane, double tolerance,
                                PointIndex firstNewPoint);

/// The points that a part's triangles use, ascending, for Part::points.
[[nodiscard]] std::vector<PointIndex> pointsUsedBy(std::span<const Triangle> triangles);

}  // namespace lorica
