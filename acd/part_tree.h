#pragma once

#include "acd/cut.h"
#include "acd/decomposition.h"
#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// A bounding volume hierarchy over a part's triangles, to find the effect of a plane without visiting all triangles.
/// Points are renumbered in the order in which the leaves first use them. Node 0 is the root.
class PartTree {
 public:
  /// @param keyframes  all points in each keyframe, indexed by PointIndex
  /// @param keyframe   the keyframe of the planes
  PartTree(const Part& part, std::span<const std::vector<Vec3>> keyframes, std::size_t keyframe);

  struct Node {
    Aabb box;                                    ///< in the keyframe of the planes
    std::int32_t first = 0, last = 0;            ///< triangles
    std::int32_t firstPoint = 0, lastPoint = 0;  ///< see pointsOf()
    std::int32_t second = -1;                    ///< second child (the first follows its parent); -1 for a leaf
  };
  [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
  /// The points of a node; points shared by several of its leaves occur several times.
  [[nodiscard]] std::span<const std::int32_t> pointsOf(std::int32_t node) const;
  /// Positions of the part's points in a keyframe [m].
  [[nodiscard]] std::span<const Vec3> points(std::size_t keyframe) const { return points_[keyframe]; }
  [[nodiscard]] std::size_t keyframeCount() const { return points_.size(); }

  /// The part of the tree on one side of a plane.
  struct Half {
    std::vector<std::int32_t> nodes;   ///< entirely on this side
    std::vector<std::int32_t> points;  ///< on this side or on the plane, in leaves that the plane intersects
  };
  /// A leaf that the plane intersects, and the ends of its entries in the lists; they start at the ends of the previous
  /// leaf's entries.
  struct CutLeaf {
    std::int32_t node = 0;
    std::size_t endAbove = 0, endBelow = 0, endCrossings = 0;
  };
  struct Sketch {
    Half above, below;
    std::vector<CutPoint> crossings;  ///< new points, used by both halves
    std::vector<CutLeaf> leaves;
  };

  /// Finds what is on each side of a plane.
  /// @param tolerance  points up to this distance count as on the plane [m]
  /// @return false if the plane does not divide the part
  bool sketch(const Plane& plane, double tolerance, Sketch& out) const;

 private:
  struct Item {
    Vec3f center;
    std::int32_t triangle;
  };
  void build(std::span<Item> items, std::int32_t node, std::int32_t first);

  std::size_t keyframe_;
  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;        // with the new point numbers, in leaf order
  std::vector<std::int32_t> leafPoints_;   // points of each leaf, in leaf order
  std::vector<std::vector<Vec3>> points_;  // keyframe, point
};

}  // namespace lorica
