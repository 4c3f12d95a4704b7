#include "collision/live/attached_vertices.h"

#include "geometry/convex_hull.h"
#include "geometry/threads.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

/// The bone that moves a point most; the first of several.
JointIndex strongest(const LiftedPoint& point) {
  const auto max = std::max_element(point.begin(), point.end(),
                                    [](const LiftedTerm& a, const LiftedTerm& b) { return a.weight < b.weight; });
  return max == point.end() ? 0 : max->joint;
}

/// The points of one part that are moved most by one bone, in the bind pose.
struct Share {
  std::size_t part = 0;
  JointIndex joint = 0;
  std::vector<Vec3> points;
  ConvexHull hull;

  /// Lower bound of a point's distance outside the hull; for a flat hull, distance from its nearest point [m].
  [[nodiscard]] double distance(const Vec3& p) const {
    if (!hull.degenerate()) return largestViolation(hull, {&p, 1});
    double minSq = std::numeric_limits<double>::infinity();
    for (const Vec3& own : points) minSq = std::min(minSq, (own - p).squaredNorm());
    return std::sqrt(minSq);
  }
};

/// The shares of all parts, by joint and then by part.
std::vector<Share> sharesOf(const Decomposition& decomposition, std::span<const LiftedPoint> lifted,
                            std::span<const Vec3> bind) {
  std::vector<Share> shares;
  for (std::size_t i = 0; i < decomposition.parts.size(); ++i) {
    std::vector<std::pair<JointIndex, PointIndex>> order;
    order.reserve(decomposition.parts[i].points.size());
    for (const PointIndex p : decomposition.parts[i].points) {
      order.emplace_back(strongest(lifted[p]), p);
    }
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k == 0 || order[k].first != order[k - 1].first) shares.push_back({i, order[k].first, {}, {}});
      shares.back().points.push_back(bind[order[k].second]);
    }
  }
  std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) { return a.joint < b.joint; });
  parallelFor(shares.size(), [&](std::size_t s) { shares[s].hull = convexHull(shares[s].points); });
  return shares;
}

/// The surfaces of all parts in the bind pose, and the part of each triangle.
struct Surface {
  std::vector<std::size_t> partOf;
  TriangleTree nearest;
};

Surface surfaceOf(const Decomposition& decomposition, std::span<const Vec3> bind) {
  std::vector<std::size_t> partOf;
  std::vector<std::array<Vec3, 3>> corners;
  for (std::size_t i = 0; i < decomposition.parts.size(); ++i) {
    for (const Triangle& t : decomposition.parts[i].triangles) {
      partOf.push_back(i);
      corners.push_back({bind[t[0]], bind[t[1]], bind[t[2]]});
    }
  }
  return {std::move(partOf), TriangleTree(std::move(corners))};
}

/// The vertices that no part contains.
std::vector<PointIndex> unusedVertices(const Decomposition& decomposition) {
  std::vector<bool> used(decomposition.pointCount(), false);
  for (const Part& part : decomposition.parts) {
    for (const PointIndex p : part.points) used[p] = true;
  }
  std::vector<PointIndex> unused;
  for (PointIndex p = 0; p < decomposition.vertexCount; ++p) {
    if (!used[p]) unused.push_back(p);
  }
  return unused;
}

}  // namespace

std::vector<std::vector<PointIndex>> attachedVerticesOf(const Decomposition& decomposition,
                                                        std::span<const LiftedPoint> lifted) {
  std::vector<std::vector<PointIndex>> attached(decomposition.parts.size());
  const std::vector<PointIndex> unused = unusedVertices(decomposition);
  if (unused.empty() || attached.empty()) return attached;

  std::vector<Vec3> bind;
  bind.reserve(lifted.size());
  for (const LiftedPoint& point : lifted) bind.push_back(bindPositionOf(point));
  const std::vector<Share> shares = sharesOf(decomposition, lifted, bind);
  const Surface surface = surfaceOf(decomposition, bind);

  std::vector<std::size_t> partOf(unused.size(), 0);
  parallelFor(unused.size(), [&](std::size_t k) {
    const std::size_t own = unused[k];
    const JointIndex joint = strongest(lifted[own]);
    auto share =
        std::lower_bound(shares.begin(), shares.end(), joint, [](const Share& s, JointIndex j) { return s.joint < j; });
    if (share == shares.end() || share->joint != joint) {
      partOf[k] = surface.partOf[surface.nearest.nearest(bind[own]).triangle];
      return;
    }
    double min = std::numeric_limits<double>::infinity();
    for (; share != shares.end() && share->joint == joint; ++share) {
      const double distance = share->distance(bind[own]);
      if (distance >= min) continue;
      min = distance;
      partOf[k] = share->part;
    }
  });
  for (std::size_t k = 0; k < unused.size(); ++k) attached[partOf[k]].push_back(unused[k]);
  return attached;
}

}  // namespace lorica
