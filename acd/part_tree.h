#pragma once

#include "acd/cut.h"
#include "acd/decomposition.h"
#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// A part's triangles in a hierarchy of boxes, so that what a plane does to the part is found without visiting all of
/// it. Points are numbered anew, in the order in which the hierarchy's leaves meet them; 0 is the root.
class PartTree {
 public:
  /// @param keyframes  all points in each keyframe, indexed by PointIndex
  /// @param keyframe   the one in which planes will be laid
  PartTree(const Part& part, std::span<const std::vector<Vec3>> keyframes, std::size_t keyframe);

  struct Node {
    Aabb box;                                    ///< in the keyframe of the planes
    std::int32_t first = 0, last = 0;            ///< triangles
    std::int32_t firstPoint = 0, lastPoint = 0;  ///< see pointsOf()
    std::int32_t second = -1;                    ///< second child, the first one follows its parent; -1: a leaf
  };
  [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
  /// The points of a node, those that its leaves share more than once.
  [[nodiscard]] std::span<const std::int32_t> pointsOf(std::int32_t node) const;
  /// Positions of the part's points in a keyframe [m].
  [[nodiscard]] std::span<const Vec3> points(std::size_t keyframe) const { return points_[keyframe]; }
  [[nodiscard]] std::size_t keyframeCount() const { return points_.size(); }

  /// What lies on each side of a plane.
  struct Half {
    std::vector<std::int32_t> nodes;   ///< wholly on this side
    std::vector<std::int32_t> points;  ///< on this side or on the plane, of triangles in leaves that the plane meets
  };
  /// A leaf that the plane meets, and where its entries in the lists end; they begin where those of the one before end.
  struct CutLeaf {
    std::int32_t node = 0;
    std::size_t endAbove = 0, endBelow = 0, endCrossings = 0;
  };
  struct Sketch {
    Half above, below;
    std::vector<CutPoint> crossings;  ///< new points, of both halves
    std::vector<CutLeaf> leaves;
  };

  /// @param tolerance  distance up to which a point counts as on the plane [m]
  /// @return false when the plane does not divide the part
  bool sketch(const Plane& plane, double tolerance, Sketch& out) const;

 private:
  struct Item {
    Vec3f center;
    std::int32_t triangle;
  };
  void build(std::span<Item> items, std::int32_t node, std::int32_t first);

  std::size_t keyframe_;
  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;        // over the new numbers, in the order of the leaves
  std::vector<std::int32_t> leafPoints_;   // each leaf's points, leaf after leaf
  std::vector<std::vector<Vec3>> points_;  // keyframe, point
};

}  // namespace lorica
