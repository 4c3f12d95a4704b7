#pragma once

#include "geometry/tri_mesh.h"

#include <array>
#include <vector>

namespace lorica {

/// Distances from points to the nearest of many triangles, by a tree of boxes. Internal to score().
class NearestTriangle {
 public:
  /// @param corners  at least one triangle; segments and points (equal corners) are fine
  explicit NearestTriangle(std::vector<std::array<Vec3, 3>> corners);

  /// Distance from p to the nearest triangle [m].
  [[nodiscard]] double distance(const Vec3& p) const;

 private:
  struct Node {
    Aabb box;
    std::int32_t first = 0;  ///< leaf: its first triangle; else: its second child (the first one follows it)
    std::int32_t count = 0;  ///< leaf: how many; 0 for an inner node
  };
  void build(std::size_t first, std::size_t count);

  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<Node> nodes_;
};

/// Squared distance from p to a triangle, which may be as thin as it likes.
[[nodiscard]] double distanceSqToTriangle(const Vec3& p, const std::array<Vec3, 3>& triangle);

}  // namespace lorica
