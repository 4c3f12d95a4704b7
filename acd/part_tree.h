#pragma once

#include "acd/cut.h"
#include "acd/decomposition.h"
#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// A part's triangles in a hierarchy of boxes. Every node keeps, for each keyframe, only those of its points that lie
/// on their convex hull: no other point of the node can lie on the hull of a half that holds the whole node. A plane
/// passes through few nodes, so the hulls of both halves come from a fraction of the part's points, without loss.
class PartTree {
 public:
  /// @param keyframes  all points in each keyframe, indexed by PointIndex; borrowed
  /// @param keyframe   the one in which planes will be laid
  /// @param tolerance  of the nodes' hulls, see convexHullPoints
  PartTree(const Part& part, std::span<const std::vector<Vec3>> keyframes, std::size_t keyframe, double tolerance);

  /// Points of the whole part's hull in a keyframe, ascending.
  [[nodiscard]] std::span<const PointIndex> hullPoints(std::size_t keyframe) const { return hullPoints_[keyframe]; }

  /// The points that can lie on the hull of each half.
  struct Sketch {
    std::vector<std::int32_t> nodesAbove, nodesBelow;  ///< nodes wholly on one side
    std::vector<PointIndex> pointsAbove, pointsBelow;  ///< of triangles in boxes that the plane meets
    std::vector<CutPoint> crossings;                   ///< new points, of both halves
  };

  /// @param tolerance  distance up to which a point counts as on the plane [m]
  /// @return false when the plane does not divide the part
  bool sketch(const Plane& plane, double tolerance, PlaneSides& sides, Sketch& out) const;

  /// Positions in a keyframe of the points of one half. @param points  replaced
  void gatherAbove(const Sketch& sketch, std::size_t keyframe, std::vector<Vec3>& points) const;
  void gatherBelow(const Sketch& sketch, std::size_t keyframe, std::vector<Vec3>& points) const;

 private:
  struct Node {
    Aabb box;                          // in the keyframe of the planes
    std::int32_t first = 0, last = 0;  // triangles, positions in order_
    std::int32_t child = -1;           // of two in a row; -1 for a leaf
    int depth = 0;
  };
  void buildNodes();
  void gather(const std::vector<std::int32_t>& nodes, const std::vector<PointIndex>& single,
              const std::vector<CutPoint>& crossings, std::size_t keyframe, std::vector<Vec3>& points) const;

  const Part& part_;
  std::span<const std::vector<Vec3>> keyframes_;
  std::size_t keyframe_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
  std::vector<std::vector<PointIndex>> hullPoints_;  // node x keyframe
};

}  // namespace lorica
