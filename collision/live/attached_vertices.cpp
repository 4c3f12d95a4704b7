#include "collision/live/attached_vertices.h"

#include "acd/nearest_triangle.h"
#include "geometry/convex_hull.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

/// The bone that moves a point most; the first of several.
JointIndex strongest(const LiftedPoint& point) {
  const auto most = std::max_element(point.begin(), point.end(),
                                     [](const LiftedTerm& a, const LiftedTerm& b) { return a.weight < b.weight; });
  return most == point.end() ? 0 : most->joint;
}

/// The points of one part that one bone moves most, in the bind pose.
struct Share {
  std::size_t part = 0;
  JointIndex joint = 0;
  std::vector<Vec3> points;
  ConvexHull hull;

  /// How far outside of the hull a point is, at least; of a flat one, from its nearest point [m].
  [[nodiscard]] double distance(const Vec3& p) const {
    if (!hull.degenerate()) return largestViolation(hull, {&p, 1});
    double leastSq = std::numeric_limits<double>::infinity();
    for (const Vec3& own : points) leastSq = std::min(leastSq, (own - p).squaredNorm());
    return std::sqrt(leastSq);
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
      order.emplace_back(strongest(lifted[static_cast<std::size_t>(p)]), p);
    }
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k == 0 || order[k].first != order[k - 1].first) shares.push_back({i, order[k].first, {}, {}});
      shares.back().points.push_back(bind[static_cast<std::size_t>(order[k].second)]);
    }
  }
  std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) { return a.joint < b.joint; });
  tbb::parallel_for(std::size_t{0}, shares.size(),
                    [&](std::size_t s) { shares[s].hull = convexHull(shares[s].points); });
  return shares;
}

/// The surfaces of all parts in the bind pose, and which part each triangle is of.
struct Surface {
  std::vector<std::size_t> partOf;
  NearestTriangle nearest;
};

Surface surfaceOf(const Decomposition& decomposition, std::span<const Vec3> bind) {
  std::vector<std::size_t> partOf;
  std::vector<std::array<Vec3, 3>> corners;
  for (std::size_t i = 0; i < decomposition.parts.size(); ++i) {
    for (const Triangle& t : decomposition.parts[i].triangles) {
      partOf.push_back(i);
      corners.push_back({bind[static_cast<std::size_t>(t[0])], bind[static_cast<std::size_t>(t[1])],
                         bind[static_cast<std::size_t>(t[2])]});
    }
  }
  return {std::move(partOf), NearestTriangle(std::move(corners))};
}

/// The vertices that no part has.
std::vector<PointIndex> unusedVertices(const Decomposition& decomposition) {
  std::vector<bool> used(static_cast<std::size_t>(decomposition.pointCount()), false);
  for (const Part& part : decomposition.parts) {
    for (const PointIndex p : part.points) used[static_cast<std::size_t>(p)] = true;
  }
  std::vector<PointIndex> unused;
  for (PointIndex p = 0; p < decomposition.vertexCount; ++p) {
    if (!used[static_cast<std::size_t>(p)]) unused.push_back(p);
  }
  return unused;
}

}  // namespace

std::vector<std::vector<PointIndex>> passengersOf(const Decomposition& decomposition,
                                                  std::span<const LiftedPoint> lifted) {
  std::vector<std::vector<PointIndex>> passengers(decomposition.parts.size());
  const std::vector<PointIndex> unused = unusedVertices(decomposition);
  if (unused.empty() || passengers.empty()) return passengers;

  std::vector<Vec3> bind;
  bind.reserve(lifted.size());
  for (const LiftedPoint& point : lifted) bind.push_back(bindPositionOf(point));
  const std::vector<Share> shares = sharesOf(decomposition, lifted, bind);
  const Surface surface = surfaceOf(decomposition, bind);

  std::vector<std::size_t> partOf(unused.size(), 0);
  tbb::parallel_for(std::size_t{0}, unused.size(), [&](std::size_t k) {
    const auto own = static_cast<std::size_t>(unused[k]);
    const JointIndex joint = strongest(lifted[own]);
    auto share =
        std::lower_bound(shares.begin(), shares.end(), joint, [](const Share& s, JointIndex j) { return s.joint < j; });
    if (share == shares.end() || share->joint != joint) {
      partOf[k] = surface.partOf[static_cast<std::size_t>(surface.nearest.nearest(bind[own]).given)];
      return;
    }
    double least = std::numeric_limits<double>::infinity();
    for (; share != shares.end() && share->joint == joint; ++share) {
      const double distance = share->distance(bind[own]);
      if (distance >= least) continue;
      least = distance;
      partOf[k] = share->part;
    }
  });
  for (std::size_t k = 0; k < unused.size(); ++k) passengers[partOf[k]].push_back(unused[k]);
  return passengers;
}

}  // namespace lorica
