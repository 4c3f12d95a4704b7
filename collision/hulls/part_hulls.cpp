#include "collision/hulls/part_hulls.h"

#include "acd/hull_budget.h"
#include "acd/transfer.h"
#include "geometry/errors.h"
#include "geometry/parallel_progress.h"
#include "geometry/threads.h"
#include "geometry/triangle_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace lorica {
namespace {

/// The planes of a hull in groups that face nearly the same way: a hull and what it holds may have very many.
class PlaneTree {
 public:
  using Plane = Eigen::Vector4d;  ///< normal and negative offset

  explicit PlaneTree(std::vector<Plane> planes) : planes_(std::move(planes)) {
    if (!planes_.empty()) build(0, planes_.size());
  }
  [[nodiscard]] bool empty() const { return planes_.empty(); }

  /// How far a point lies above the planes, at least `most`. Stops when that is `enough`.
  [[nodiscard]] double height(const Vec3& p, double most, double enough) const {
    const Plane at = p.homogeneous();
    for (std::size_t n = 0; n < nodes_.size() && most < enough;) {
      const Node& node = nodes_[n];
      const bool skipped = node.low.cwiseProduct(at).cwiseMax(node.high.cwiseProduct(at)).sum() <= most;
      for (std::size_t i = node.first; !skipped && node.leaf && i < node.end; ++i) {
        most = std::max(most, planes_[i].dot(at));
      }
      n = skipped ? node.next : n + 1;
    }
    return most;
  }

 private:
  struct Node {
    Plane low, high;               ///< of all its planes
    std::size_t first, end, next;  ///< its planes, and the node after those below it
    bool leaf;
  };

  void build(std::size_t first, std::size_t end) {
    constexpr std::size_t kLeafSize = 8;
    const std::size_t own = nodes_.size();
    Node node{planes_[first], planes_[first], first, end, 0, end - first <= kLeafSize};
    for (std::size_t i = first; i < end; ++i) {
      node.low = node.low.cwiseMin(planes_[i]);
      node.high = node.high.cwiseMax(planes_[i]);
    }
    nodes_.push_back(node);
    if (!node.leaf) {
      Eigen::Index axis = 0;
      (node.high - node.low).head<3>().maxCoeff(&axis);
      const std::size_t middle = (first + end) / 2;
      std::nth_element(planes_.begin() + first, planes_.begin() + middle, planes_.begin() + end,
                       [axis](const Plane& a, const Plane& b) { return a[axis] < b[axis]; });
      build(first, middle);
      build(middle, end);
    }
    nodes_[own].next = nodes_.size();
  }

  std::vector<Plane> planes_;
  std::vector<Node> nodes_;  ///< each before those below it
};

}  // namespace

std::vector<ConvexHull> hullsIn(const Decomposition& decomposition, std::span<const Vec3> vertices) {
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, vertices, points);
  return partHulls(decomposition, points);
}

PartHulls simplifyHulls(std::span<const ConvexHull> hulls, const HullBudget& budget, int threads,
                        const std::function<bool(int done, int hulls)>& progress) {
  std::vector<BudgetedHull> exported(hulls.size());
  (void)inParallel(hulls.size(), threads, progress, [&](std::size_t i) {
    const ConvexHull& hull = hulls[i];
    exported[i] =
        budget.given() ? simplifyHull(hull, budget) : BudgetedHull{{hull.vertices, hull.triangles}, hull.volume, 1.0};
  });

  PartHulls result;
  result.objects.reserve(hulls.size());
  result.growth.reserve(hulls.size());
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < hulls.size(); ++i) {
    before += hulls[i].volume;
    after += exported[i].volume;
    result.growth.push_back(exported[i].growth);
    result.maxVertices = std::max(result.maxVertices, exported[i].mesh.vertices.size());
    result.maxVerticesBefore = std::max(result.maxVerticesBefore, hulls[i].vertices.size());
    result.objects.push_back({fmt::format("part_{}", i), std::move(exported[i].mesh)});
  }
  if (before > 0.0) result.totalGrowth = after / before;
  return result;
}

Result<void> checkHullsHold(const PartHulls& hulls, std::span<const Vec3> vertices,
                            std::span<const VertexIndex> which) {
  constexpr double kOutside = 1e-6;  // of the diagonal
  struct Solid {
    std::vector<Vec3> vertices;
    Aabb box;
    PlaneTree planes;  // none if it is flat
  };
  if (which.empty()) return {};
  const Vec3 origin = vertices[which.front()];  // near the hulls: planes far from 0 are hard to tell apart
  std::vector<Solid> solids;
  Aabb all;
  for (const NamedMesh& object : hulls.objects) {
    const std::vector<Vec3>& corners = object.mesh.vertices;
    const Aabb box = boundsOf(corners);
    for (const Vec3& p : corners) all.extend(p);
    std::vector<PlaneTree::Plane> planes;
    for (const Triangle& t : object.mesh.triangles) {
      const Vec3& a = corners[t[0]];
      const Vec3 ab = corners[t[1]] - a;
      const Vec3 ac = corners[t[2]] - a;
      // The plane of a sliver is meaningless, see largestViolation().
      const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
      if (ab.cross(ac).norm() <= 1e-7 * box.diagonal() * longest) continue;
      const Vec3 normal = ab.cross(ac).normalized();
      planes.emplace_back(normal.x(), normal.y(), normal.z(), -normal.dot(a - origin));
    }
    solids.push_back({corners, box, PlaneTree(std::move(planes))});
  }
  const double tolerance = kOutside * all.diagonal();
  std::vector<double> outside(which.size(), 0.0);
  constexpr std::size_t kBlock = 256;  // neighbours are often in the same hull: that of the last one is asked first
  parallelFor((which.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    std::size_t likely = 0;
    for (std::size_t k = block * kBlock; k < std::min(which.size(), (block + 1) * kBlock); ++k) {
      const Vec3& p = vertices[which[k]];
      double least = kInfinity;
      for (std::size_t i = 0; i < solids.size() && least > tolerance; ++i) {
        const std::size_t asked = (likely + i) % solids.size();
        const auto& [corners, box, planes] = solids[asked];
        double distance = (box.min - p).cwiseMax(p - box.max).cwiseMax(0.0).norm();
        distance = planes.height(p - origin, distance, least);
        if (planes.empty()) {
          distance = kInfinity;
          for (const Vec3& corner : corners) distance = std::min(distance, (corner - p).norm());
        }
        least = std::min(least, distance);
        if (least <= tolerance) likely = asked;
      }
      outside[k] = least;
    }
  });
  // Planes of triangles that are nearly slivers say too much: the distance from the triangles decides.
  std::vector<std::unique_ptr<TriangleTree>> trees(solids.size());
  for (std::size_t k = 0; k < which.size(); ++k) {
    if (outside[k] <= tolerance) continue;
    for (std::size_t i = 0; i < solids.size() && outside[k] > tolerance; ++i) {
      if (solids[i].planes.empty() || distanceSqToBox(vertices[which[k]], solids[i].box) > tolerance * tolerance)
        continue;
      const TriMesh& hull = hulls.objects[i].mesh;
      if (trees[i] == nullptr) trees[i] = std::make_unique<TriangleTree>(hull.vertices, hull.triangles);
      const Vec3& p = vertices[which[k]];
      outside[k] = trees[i]->windingNumber(p) > 0.5 ? 0.0 : std::min(outside[k], trees[i]->distance(p));
    }
  }
  const auto worst = std::max_element(outside.begin(), outside.end());
  if (*worst <= tolerance) return {};
  const VertexIndex v = which[worst - outside.begin()];
  const Vec3& p = vertices[v];
  return badMesh(
      "vertex {} at ({:g}, {:g}, {:g}) is {:g} outside all hulls, expected at most {:g}; nothing was written", v, p.x(),
      p.y(), p.z(), *worst, tolerance);
}

}  // namespace lorica
