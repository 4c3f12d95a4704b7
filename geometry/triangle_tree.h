#pragma once

#include "geometry/tri_mesh.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lorica {

/// A bounding volume hierarchy for nearest points and winding numbers of a surface. Internal: not installed.
class TriangleTree {
 public:
  struct Hit {
    double distance = std::numeric_limits<double>::infinity();  ///< [m]; infinite if there is none
    std::int32_t triangle = -1;                                 ///< index in the input
    std::int32_t entry = -1;                                    ///< for corners()
    Vec3 shares = Vec3::Zero();                                 ///< barycentric: point = sum of shares x corners
  };

  /// What a tree is asked for: without winding numbers it is built in half the time.
  enum class Use { kAll, kDistances };

  /// @param corners  of at least one triangle; segments and points (equal corners) are allowed
  explicit TriangleTree(std::vector<std::array<Vec3, 3>> corners, Use use = Use::kAll);
  /// @param triangles  at least one
  TriangleTree(std::span<const Vec3> vertices, std::span<const Triangle> triangles, Use use = Use::kAll);

  /// The nearest of the triangles for which `accept(triangle)` is true; on ties the first.
  /// @param within  maximum distance [m]
  /// @param enough  one that is no farther than this will do [m]
  template <typename Accept>
  [[nodiscard]] Hit nearest(const Vec3& p, double within, Accept&& accept, double enough = -1.0) const;
  [[nodiscard]] Hit nearest(const Vec3& p, double enough = -1.0) const {
    return nearest(
        p, std::numeric_limits<double>::infinity(), [](std::int32_t) { return true; }, enough);
  }

  /// Distance from p to the nearest triangle [m]; to any that is no farther than `enough`, if there is one.
  [[nodiscard]] double distance(const Vec3& p, double enough = -1.0) const { return nearest(p, enough).distance; }
  /// The nearest triangle.
  [[nodiscard]] const std::array<Vec3, 3>& corners(const Hit& hit) const { return corners_[hit.entry]; }

  /// Calls visit(triangle, distance) for all triangles within `radius` of p.
  template <typename Visit>
  void forEachWithin(const Vec3& p, double radius, Visit&& visit) const;

  /// Calls visit(triangle) for all triangles that reach into a box, and for others near them.
  template <typename Visit>
  void forEachNear(const Aabb& box, Visit&& visit) const;

  /// How often the surface winds around p: 1 inside and 0 outside if it is closed and its triangles are
  /// counter-clockwise from outside; values in between if it is open (Jacobson et al. 2013). Distant groups of
  /// triangles are treated as one dipole (Barill et al. 2018), accurate to a few hundredths.
  /// @param looked  if given, increased by the number of triangles that were looked at one by one
  [[nodiscard]] double windingNumber(const Vec3& p, std::size_t* looked = nullptr) const;

 private:
  struct Node {
    Aabb box;
    Vec3 center = Vec3::Zero();  ///< mean of the triangles, by area
    Vec3 dipole = Vec3::Zero();  ///< sum of normal x area
    double radius = 0.0;         ///< around the center, of all corners
    std::int32_t first = 0;      ///< leaf: its first triangle; else: its second child (the first one follows it)
    std::int32_t count = 0;      ///< leaf: number of triangles; 0 for an inner node
  };
  /// Calls visit(entry) for the triangles of groups whose box `reaches(box)` lets pass.
  template <typename Reaches, typename Visit>
  void forEachEntry(Reaches&& reaches, Visit&& visit) const;
  void build(std::span<const Vec3> centers, std::size_t first, std::size_t count);
  void measure(Node& node, std::size_t first, std::size_t count) const;

  std::vector<std::array<Vec3, 3>> corners_;  ///< in the order of the tree
  std::vector<std::int32_t> original_;
  std::vector<Node> nodes_;
  Use use_;
};

/// The nearest point of a triangle, which may be degenerate.
/// @return squared distance and barycentric coordinates
[[nodiscard]] std::pair<double, Vec3> nearestOnTriangle(const Vec3& p, const std::array<Vec3, 3>& triangle);

[[nodiscard]] inline bool overlap(const Aabb& a, const Aabb& b) {
  return (a.min.array() <= b.max.array()).all() && (b.min.array() <= a.max.array()).all();
}

[[nodiscard]] inline double distanceSqToBox(const Vec3& p, const Aabb& box) {
  return (box.min - p).cwiseMax(p - box.max).cwiseMax(0.0).squaredNorm();
}

template <typename Accept>
TriangleTree::Hit TriangleTree::nearest(const Vec3& p, double within, Accept&& accept, double enough) const {
  Hit hit;
  double best = within * within;
  std::array<std::pair<std::int32_t, double>, 64> stack;  // the tree is balanced: never deeper than 32
  int depth = 0;
  stack[depth++] = {0, distanceSqToBox(p, nodes_[0].box)};
  while (depth > 0) {
    const auto [index, boxDistanceSq] = stack[--depth];
    if (boxDistanceSq > best) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        const auto [distanceSq, shares] = nearestOnTriangle(p, corners_[i]);
        if (distanceSq > best || (distanceSq == best && hit.triangle >= 0 && original_[i] > hit.triangle)) continue;
        if (!accept(original_[i])) continue;
        best = distanceSq;
        hit = {std::sqrt(distanceSq), original_[i], i, shares};
        if (hit.distance <= enough) return hit;
      }
      continue;
    }
    std::pair<std::int32_t, double> near{index + 1, distanceSqToBox(p, nodes_[index + 1].box)};
    std::pair<std::int32_t, double> far{node.first, distanceSqToBox(p, nodes_[node.first].box)};
    if (far.second < near.second) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return hit;
}

template <typename Visit>
void TriangleTree::forEachWithin(const Vec3& p, double radius, Visit&& visit) const {
  const double radiusSq = radius * radius;
  forEachEntry([&](const Aabb& box) { return distanceSqToBox(p, box) <= radiusSq; },
               [&](std::int32_t entry) {
                 const double distanceSq = nearestOnTriangle(p, corners_[entry]).first;
                 if (distanceSq <= radiusSq) visit(original_[entry], std::sqrt(distanceSq));
               });
}

template <typename Visit>
void TriangleTree::forEachNear(const Aabb& box, Visit&& visit) const {
  forEachEntry([&](const Aabb& other) { return overlap(box, other); },
               [&](std::int32_t entry) { visit(original_[entry]); });
}

template <typename Reaches, typename Visit>
void TriangleTree::forEachEntry(Reaches&& reaches, Visit&& visit) const {
  std::array<std::int32_t, 64> stack;
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::int32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!reaches(node.box)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = index + 1;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) visit(i);
  }
}

/// Points spread evenly over triangles, one in each of equally many strips of equal area: at random in the strip, or in
/// its middle without a seed.
/// @return none if the triangles have no area
[[nodiscard]] std::vector<Vec3> spreadPoints(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                             int count, std::optional<std::uint64_t> seed = {});

}  // namespace lorica
