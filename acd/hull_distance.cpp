#include "acd/hull_distance.h"

#include "geometry/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace lorica {

namespace {

constexpr double kRelativeTolerance = 0.01;
constexpr double kFinest = 1e-3;  // fraction of the hull's diagonal

/// A triangle of the hull, or a part of one.
struct SubHull {
  std::array<Vec3, 3> corners;
  double bound = 0.0;       // upper bound of the distance of all its points
  std::int64_t number = 0;  // order of creation, breaks ties between equal bounds
};

/// Heap order: the highest bound is at the front.
bool comesLater(const SubHull& a, const SubHull& b) {
  return a.bound != b.bound ? a.bound < b.bound : a.number > b.number;
}

class Search {
 public:
  Search(std::span<const Vec3> points, std::span<const Triangle> triangles)
      : surface_(points, triangles, TriangleTree::Use::kDistances) {}

  void add(const std::array<Vec3, 3>& corners, double bound) {
    pieces_.push_back({corners, bound, created_++});
    std::push_heap(pieces_.begin(), pieces_.end(), comesLater);
  }

  double run(double ignoreBelow, double enough) {
    double passed = 0.0;  // the largest bound of pieces that are not looked at further
    while (!pieces_.empty() && reached_ <= enough) {
      const auto [corners, before, number] = pieces_.front();
      const auto matters = [&](double bound) {
        return bound > std::max((1.0 + kRelativeTolerance) * reached_, ignoreBelow);
      };
      if (!matters(before)) return std::max({before, passed, reached_});
      std::pop_heap(pieces_.begin(), pieces_.end(), comesLater);
      pieces_.pop_back();
      const Piece piece(corners, surface_);
      reached_ = std::max(reached_, piece.distance);
      const double bound = std::min(before, piece.bound());
      if (matters(bound)) {
        for (const auto& [half, farthest] : piece.halves()) add(half, std::min(bound, farthest));
      } else {
        passed = std::max(passed, bound);
      }
    }
    return std::max(reached_, reached_ > enough ? 0.0 : passed);
  }

 private:
  /// A triangle of the hull, or a part of one, and the triangle of the surface that is nearest to its center.
  struct Piece {
    std::array<Vec3, 3> corners;
    Vec3 center;
    std::array<Vec3, 3> nearest;
    double distance = 0.0;              // of the center
    std::array<double, 3> toNearest{};  // of the corners

    Piece(const std::array<Vec3, 3>& of, const TriangleTree& surface)
        : corners(of), center((of[0] + of[1] + of[2]) / 3.0) {
      const TriangleTree::Hit hit = surface.nearest(center);
      nearest = surface.corners(hit);
      distance = hit.distance;
      for (std::size_t i = 0; i < 3; ++i) toNearest[i] = from(corners[i]);
    }

    [[nodiscard]] double from(const Vec3& p) const { return std::sqrt(nearestOnTriangle(p, nearest).first); }

    /// Distance that no point of the piece exceeds.
    [[nodiscard]] double bound() const {
      double radiusSq = 0.0;
      for (const Vec3& corner : corners) radiusSq = std::max(radiusSq, (corner - center).squaredNorm());
      return std::min(distance + std::sqrt(radiusSq), *std::max_element(toNearest.begin(), toNearest.end()));
    }

    /// Both halves, divided at the middle of the longest side, each with a distance that no point of it exceeds.
    [[nodiscard]] std::array<std::pair<std::array<Vec3, 3>, double>, 2> halves() const {
      const auto lengthSq = [&](std::size_t i) { return (corners[(i + 1) % 3] - corners[i]).squaredNorm(); };
      std::size_t i = 0;
      for (const std::size_t other : {1u, 2u}) i = lengthSq(other) > lengthSq(i) ? other : i;
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const Vec3 middle = 0.5 * (corners[i] + corners[j]);
      const double there = from(middle);
      return {{{{corners[i], middle, corners[k]}, std::max({toNearest[i], there, toNearest[k]})},
               {{middle, corners[j], corners[k]}, std::max({there, toNearest[j], toNearest[k]})}}};
    }
  };

  TriangleTree surface_;
  std::vector<SubHull> pieces_;  // a heap
  double reached_ = 0.0;         // largest distance of a point that was looked at: a lower bound
  std::int64_t created_ = 0;
};

}  // namespace

double hullDistance(const ConvexHull& hull, std::span<const Vec3> points, std::span<const Triangle> triangles,
                    double ignoreBelow, double enough) {
  if (hull.degenerate()) return 0.0;
  Search search(points, triangles);
  const double all = boundsOf(hull.vertices).diagonal();
  for (const Triangle& t : hull.triangles) {
    search.add({hull.vertices[t[0]], hull.vertices[t[1]], hull.vertices[t[2]]}, all);
  }
  return search.run(std::max(ignoreBelow, kFinest * all), enough);
}

}  // namespace lorica
