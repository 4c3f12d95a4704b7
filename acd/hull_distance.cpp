#include "acd/hull_distance.h"

#include "acd/cut.h"
#include "geometry/edge_table.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace lorica {

namespace {

constexpr double kRelativeTolerance = 0.01;
constexpr double kFinest = 1e-3;            // fraction of the hull's diagonal
constexpr double kFlat = 1e-7;              // of the hull's diagonal: as far are triangles of one face from its plane
constexpr std::size_t kManyTriangles = 16;  // of a flat face
constexpr std::size_t kFewCorners = 4;      // of what is left of a flat face

Vec3 meanOf(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

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
  Search(std::span<const Vec3> points, std::span<const Triangle> triangles, double ignoreBelow, double enough)
      : surface_(points, triangles, TriangleTree::Use::kDistances), ignoreBelow_(ignoreBelow), enough_(enough) {}

  void add(const std::array<Vec3, 3>& corners, double bound) {
    pieces_.push_back({corners, bound, created_++});
    std::push_heap(pieces_.begin(), pieces_.end(), comesLater);
  }

  /// A convex polygon. It is halved until few corners are left: its triangles could be needles as long as itself.
  void addFace(const std::vector<Vec3>& corners, double bound) {
    if (reached_ > enough_) return;
    if (corners.size() <= kFewCorners) {
      for (std::size_t i = 1; i + 1 < corners.size(); ++i) add({corners[0], corners[i], corners[i + 1]}, bound);
      return;
    }
    const Vec3 center = meanOf(corners);
    const TriangleTree::Hit hit = surface_.nearest(center);
    reached_ = std::max(reached_, hit.distance);
    double radius = 0.0, farthest = 0.0;
    for (const Vec3& corner : corners) {
      radius = std::max(radius, (corner - center).norm());
      farthest = std::max(farthest, std::sqrt(nearestOnTriangle(corner, surface_.corners(hit)).first));
    }
    bound = std::min({bound, hit.distance + radius, farthest});
    if (!matters(bound)) {
      passed_ = std::max(passed_, bound);
      return;
    }
    const Aabb box = boundsOf(corners);
    Eigen::Index axis = 0;
    (box.max - box.min).maxCoeff(&axis);
    const Vec3 across = Vec3::Unit(axis);
    for (const double side : {1.0, -1.0}) {
      std::vector<Vec3> half = corners, scratch;
      keepBelow(half, {side * across, side * box.center()[axis]}, scratch);
      addFace(half, bound);
    }
  }

  double run() {
    while (!pieces_.empty() && reached_ <= enough_) {
      const auto [corners, before, number] = pieces_.front();
      if (!matters(before)) return std::max({before, passed_, reached_});
      std::pop_heap(pieces_.begin(), pieces_.end(), comesLater);
      pieces_.pop_back();
      const Piece piece(corners, surface_);
      reached_ = std::max(reached_, piece.distance);
      const double bound = std::min(before, piece.bound());
      if (matters(bound)) {
        for (const auto& [half, farthest] : piece.halves()) add(half, std::min(bound, farthest));
      } else {
        passed_ = std::max(passed_, bound);
      }
    }
    return std::max(reached_, reached_ > enough_ ? 0.0 : passed_);
  }

 private:
  [[nodiscard]] bool matters(double bound) const {
    return bound > std::max((1.0 + kRelativeTolerance) * reached_, ignoreBelow_);
  }

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
  double ignoreBelow_, enough_;
  std::vector<SubHull> pieces_;  // a heap
  double reached_ = 0.0;         // largest distance of a point that was looked at: a lower bound
  double passed_ = 0.0;          // the largest bound of pieces that are not looked at further
  std::int64_t created_ = 0;
};

/// For each triangle of a hull, the one across each side.
std::vector<std::array<std::int32_t, 3>> neighborsOf(const ConvexHull& hull) {
  std::vector<std::array<std::int32_t, 3>> neighbors(hull.triangles.size());
  EdgeTable(hull.vertices.size(), hull.triangles).forEachEdge([&](VertexIndex, std::span<const TriangleSide> sides) {
    for (const auto& [own, other] : {std::pair{sides.front(), sides.back()}, std::pair{sides.back(), sides.front()}}) {
      const Triangle& t = hull.triangles[own.triangle];
      const auto larger = std::find(t.begin(), t.end(), own.larger) - t.begin();
      neighbors[own.triangle][own.ascending ? (larger + 2) % 3 : larger] = other.triangle;
    }
  });
  return neighbors;
}

/// A convex polygon of points that lie in a plane.
std::vector<Vec3> polygonOf(std::vector<Vec3> points, const Vec3& normal) {
  const Vec3 center = meanOf(points);
  const Vec3 right = (points[0] - center).normalized(), up = normal.cross(right);
  // Rises with the angle, from 0 to 4.
  const auto turn = [&](const Vec3& p) {
    const double x = right.dot(p - center), y = up.dot(p - center);
    const double share = x / (std::abs(x) + std::abs(y));
    return y >= 0.0 ? 1.0 - share : 3.0 + share;
  };
  std::ranges::sort(points, {}, turn);
  return points;
}

/// Adds the surface of a hull: flat faces of many triangles as polygons, other triangles one by one.
void addSurface(const ConvexHull& hull, double diagonal, Search& search) {
  const std::vector<std::array<std::int32_t, 3>> neighbors = neighborsOf(hull);
  std::vector<double> area;
  for (const Triangle& t : hull.triangles) area.push_back(areaNormal(hull.vertices, t).norm());
  std::vector<std::int32_t> largestFirst(hull.triangles.size()), face;
  std::iota(largestFirst.begin(), largestFirst.end(), 0);
  std::ranges::stable_sort(largestFirst, std::greater{}, [&](std::int32_t t) { return area[t]; });
  std::vector<bool> seen(hull.triangles.size()), inPolygon(hull.triangles.size());
  std::vector<std::vector<Vec3>> polygons;
  for (const std::int32_t seed : largestFirst) {
    if (seen[seed] || area[seed] == 0.0) continue;
    const Vec3 normal = areaNormal(hull.vertices, hull.triangles[seed]).normalized();
    const auto onPlane = [&](VertexIndex v) {
      return std::abs(normal.dot(hull.vertices[v] - hull.vertices[hull.triangles[seed][0]])) <= kFlat * diagonal;
    };
    face.assign(1, seed);
    seen[seed] = true;
    for (std::size_t i = 0; i < face.size(); ++i) {
      for (const std::int32_t next : neighbors[face[i]]) {
        if (seen[next] || !std::ranges::all_of(hull.triangles[next], onPlane)) continue;
        seen[next] = true;
        face.push_back(next);
      }
    }
    if (face.size() < kManyTriangles) continue;
    std::set<VertexIndex> corners;
    for (const std::int32_t t : face) {
      inPolygon[t] = true;
      corners.insert(hull.triangles[t].begin(), hull.triangles[t].end());
    }
    std::vector<Vec3>& polygon = polygons.emplace_back();
    for (const VertexIndex v : corners) polygon.push_back(hull.vertices[v]);
    polygon = polygonOf(std::move(polygon), normal);
  }
  for (std::size_t t = 0; t < hull.triangles.size(); ++t) {
    const auto& [a, b, c] = hull.triangles[t];
    if (!inPolygon[t]) search.add({hull.vertices[a], hull.vertices[b], hull.vertices[c]}, diagonal);
  }
  for (const std::vector<Vec3>& polygon : polygons) search.addFace(polygon, diagonal);
}

}  // namespace

double hullDistance(const ConvexHull& hull, std::span<const Vec3> points, std::span<const Triangle> triangles,
                    double ignoreBelow, double enough) {
  if (hull.degenerate()) return 0.0;
  const double diagonal = boundsOf(hull.vertices).diagonal();
  Search search(points, triangles, std::max(ignoreBelow, kFinest * diagonal), enough);
  addSurface(hull, diagonal, search);
  return search.run();
}

}  // namespace lorica
