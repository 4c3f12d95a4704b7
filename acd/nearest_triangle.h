#pragma once

#include "geometry/tri_mesh.h"

#include <array>
#include <vector>

namespace lorica {

/// Distances from points to the nearest of many triangles, by a tree of boxes. Internal: not installed.
class NearestTriangle {
 public:
  /// The nearest triangle to a point; of several as near, whichever the tree meets first.
  struct Hit {
    double distance = 0.0;   ///< [m]
    std::int32_t index = 0;  ///< for corners()
    std::int32_t given = 0;  ///< the same triangle in the order in which they were given
  };

  /// @param corners  at least one triangle; segments and points (equal corners) are fine
  explicit NearestTriangle(std::vector<std::array<Vec3, 3>> corners);

  /// Distance from p to the nearest triangle [m].
  [[nodiscard]] double distance(const Vec3& p) const { return nearest(p).distance; }

  [[nodiscard]] Hit nearest(const Vec3& p) const;

  /// A triangle by the index of a hit; not the order in which they were given.
  [[nodiscard]] const std::array<Vec3, 3>& corners(std::int32_t index) const {
    return triangles_[static_cast<std::size_t>(index)].corners;
  }

 private:
  struct Node {
    Aabb box;
    std::int32_t first = 0;  ///< leaf: its first triangle; else: its second child (the first one follows it)
    std::int32_t count = 0;  ///< leaf: how many; 0 for an inner node
  };
  struct Entry {
    std::array<Vec3, 3> corners;
    std::int32_t given = 0;
  };
  void build(std::size_t first, std::size_t count);

  std::vector<Entry> triangles_;
  std::vector<Node> nodes_;
};

/// Squared distance from p to a triangle, which may be as thin as it likes.
[[nodiscard]] double distanceSqToTriangle(const Vec3& p, const std::array<Vec3, 3>& triangle);

}  // namespace lorica
