#include "acd/hull_distance.h"

#include "geometry/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

/// Splits a triangle at the midpoint of its longest side.
std::array<std::array<Vec3, 3>, 2> halved(const std::array<Vec3, 3>& t) {
  int longest = 0;
  double longestSq = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double lengthSq = (t[(i + 1) % 3] - t[i]).squaredNorm();
    if (lengthSq <= longestSq) continue;
    longestSq = lengthSq;
    longest = i;
  }
  const Vec3& a = t[longest];
  const Vec3& b = t[(longest + 1) % 3];
  const Vec3& c = t[(longest + 2) % 3];
  const Vec3 middle = 0.5 * (a + b);
  return {{{a, middle, c}, {middle, b, c}}};
}

class Search {
 public:
  explicit Search(std::vector<std::array<Vec3, 3>> surface) : nearest_(std::move(surface)) {}

  void add(const std::array<Vec3, 3>& corners, double parentBound) {
    const Vec3 center = (corners[0] + corners[1] + corners[2]) / 3.0;
    const TriangleTree::Hit hit = nearest_.nearest(center);
    reached_ = std::max(reached_, hit.distance);
    double radiusSq = 0.0;
    double toOneSq = 0.0;
    for (const Vec3& corner : corners) {
      radiusSq = std::max(radiusSq, (corner - center).squaredNorm());
      toOneSq = std::max(toOneSq, nearestOnTriangle(corner, nearest_.corners(hit)).first);
    }
    const double bound = std::min({parentBound, hit.distance + std::sqrt(radiusSq), std::sqrt(toOneSq)});
    if (bound <= reached_) return;
    pieces_.push_back({corners, bound, created_++});
    std::push_heap(pieces_.begin(), pieces_.end(), comesLater);
  }

  double run(double ignoreBelow, double enough) {
    while (!pieces_.empty() && reached_ <= enough) {
      const SubHull worst = pieces_.front();
      if (worst.bound <= std::max((1.0 + kRelativeTolerance) * reached_, ignoreBelow)) {
        return std::max(worst.bound, reached_);
      }
      std::pop_heap(pieces_.begin(), pieces_.end(), comesLater);
      pieces_.pop_back();
      for (const std::array<Vec3, 3>& half : halved(worst.corners)) add(half, worst.bound);
    }
    return reached_;
  }

 private:
  TriangleTree nearest_;
  std::vector<SubHull> pieces_;  // a heap
  double reached_ = 0.0;         // largest distance of an evaluated point: a lower bound
  std::int64_t created_ = 0;
};

}  // namespace

double hullDistance(const ConvexHull& hull, std::span<const Vec3> points, std::span<const Triangle> triangles,
                    double ignoreBelow, double enough) {
  if (hull.degenerate()) return 0.0;
  std::vector<std::array<Vec3, 3>> surface;
  surface.reserve(triangles.size());
  const auto cornersOf = [](const auto& vertices, const Triangle& t) {
    return std::array<Vec3, 3>{vertices[t[0]], vertices[t[1]], vertices[t[2]]};
  };
  for (const Triangle& t : triangles) surface.push_back(cornersOf(points, t));
  Search search(std::move(surface));
  const double all = boundsOf(hull.vertices).diagonal();
  for (const Triangle& t : hull.triangles) search.add(cornersOf(hull.vertices, t), all);
  return search.run(std::max(ignoreBelow, kFinest * all), enough);
}

}  // namespace lorica
