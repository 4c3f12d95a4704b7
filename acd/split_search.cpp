#include "acd/split_search.h"

#include "acd/cut.h"
#include "acd/part_tree.h"
#include "geometry/convex_hull.h"

#include <tbb/parallel_for.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

namespace lorica {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A half whose hull is smaller than this share of the mesh is no solid.
constexpr double kSolid = 1e-9;

class SplitSearch {
 public:
  SplitSearch(const Workpiece& piece, std::size_t keyframe, const Workshop& shop, const SplitEffort& effort)
      : piece_(piece),
        keyframe_(keyframe),
        shop_(shop),
        effort_(effort),
        tree_(piece.part, shop.points, keyframe, effort.coarse) {}

  std::optional<Split> run() {
    std::vector<Plane> planes = candidates();
    std::vector<double> scores = scoreAll(planes);
    std::vector<std::size_t> ranked = rank(scores);
    if (ranked.empty()) return std::nullopt;
    if (effort_.refinedPlanes > 0) {
      // Refining starts from the best planes that differ; the results compete with all others.
      std::vector<Plane> starts;
      for (std::size_t i : ranked) {
        if (static_cast<int>(starts.size()) == effort_.refinedPlanes) break;
        const bool known =
            std::any_of(starts.begin(), starts.end(), [&](const Plane& s) { return close(s, planes[i]); });
        if (!known) starts.push_back(planes[i]);
      }
      for (const Plane& start : starts) {
        const auto [plane, score] = refine(start);
        planes.push_back(plane);
        scores.push_back(score);
      }
      ranked = rank(scores);
    }
    return Split{planes[ranked[0]], keyframe_, scores[ranked[0]]};
  }

 private:
  [[nodiscard]] const std::vector<Vec3>& points() const { return shop_.points[keyframe_]; }

  [[nodiscard]] std::vector<Plane> candidates() const {
    std::vector<Vec3> hullPoints;
    for (PointIndex p : tree_.hullPoints(keyframe_)) hullPoints.push_back(points()[static_cast<std::size_t>(p)]);
    const ConvexHull hull = convexHull(hullPoints);
    const double spacing = effort_.edgeSpacing * boundsOf(hullPoints).diagonal();
    std::vector<Plane> planes;
    for (const ConcaveEdge& edge :
         deepestConcaveEdges(piece_.creases, shop_.mesh.triangles, points(), hull, effort_.candidateEdges, spacing)) {
      for (const Plane& plane : planesThrough(edge, effort_.planesPerEdge)) planes.push_back(plane);
    }
    for (const Plane& plane : componentPlanes(piece_.part, points())) planes.push_back(plane);
    if (effort_.axisPlanes > 0) addAxisPlanes(hullPoints, planes);
    return planes;
  }

  /// Evenly spaced planes across the coordinate axes and across the principal axes of the part's hull points.
  void addAxisPlanes(const std::vector<Vec3>& hullPoints, std::vector<Plane>& planes) const {
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : hullPoints) mean += p / static_cast<double>(hullPoints.size());
    Mat3 covariance = Mat3::Zero();
    for (const Vec3& p : hullPoints) covariance += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(covariance);
    std::vector<Vec3> axes = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    for (int i = 0; i < 3; ++i) {
      const Vec3 axis = solver.eigenvectors().col(i);
      if (axis.cwiseAbs().maxCoeff() < 0.98) axes.push_back(axis);
    }
    for (const Vec3& axis : axes) {
      double low = kInfinity, high = -kInfinity;
      for (const Vec3& p : hullPoints) {
        low = std::min(low, axis.dot(p));
        high = std::max(high, axis.dot(p));
      }
      for (int i = 1; i <= effort_.axisPlanes; ++i)
        planes.push_back({axis, low + (high - low) * i / (effort_.axisPlanes + 1)});
    }
  }

  /// Scores planes in parallel. Where only the best one counts, a plane that cannot be it any more is given up and
  /// scores infinity; the best one never is, so the choice does not depend on which thread finishes first.
  [[nodiscard]] std::vector<double> scoreAll(std::span<const Plane> planes) const {
    const bool winnerOnly = effort_.refinedPlanes == 0;
    std::vector<double> scores(planes.size());
    std::atomic<double> best = kInfinity;
    tbb::parallel_for(std::size_t{0}, planes.size(), [&](std::size_t i) {
      scores[i] = score(planes[i], winnerOnly ? best.load() : kInfinity);
      double known = best.load();
      while (scores[i] < known && !best.compare_exchange_weak(known, scores[i])) {
      }
    });
    return scores;
  }

  static std::vector<std::size_t> rank(const std::vector<double>& scores) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < scores.size(); ++i) {
      if (!std::isinf(scores[i])) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return scores[a] < scores[b]; });
    return order;
  }

  /// Sum of both halves' hull volumes over all keyframes; infinity when the plane leaves no solid on a side, or once
  /// the sum must exceed `toBeat`, since hulls hold at least the part itself.
  [[nodiscard]] double score(const Plane& plane, double toBeat) const {
    thread_local PlaneSides sides;
    thread_local PartTree::Sketch sketch;
    thread_local std::vector<Vec3> own;
    if (!tree_.sketch(plane, shop_.onPlane[keyframe_], sides, sketch)) return kInfinity;
    const double smallest = kSolid * std::abs(shop_.meshVolume[keyframe_]);
    double rest = std::accumulate(piece_.volume.begin(), piece_.volume.end(), 0.0);
    double total = 0.0;
    const std::size_t frameCount = shop_.keyframeCount();
    for (std::size_t i = 0; i < frameCount; ++i) {
      const std::size_t k = (keyframe_ + i) % frameCount;  // the plane's own keyframe first: it refuses flat halves
      rest -= piece_.volume[k];
      tree_.gatherAbove(sketch, k, own);
      const double above = convexHullVolume(own, effort_.coarse);
      tree_.gatherBelow(sketch, k, own);
      const double below = convexHullVolume(own, effort_.coarse);
      if (i == 0 && (above <= smallest || below <= smallest)) return kInfinity;
      total += above + below;
      if (total + std::max(rest, 0.0) * (1.0 - 1e-9) > toBeat * (1.0 + 1e-9)) return kInfinity;
    }
    return total;
  }

  [[nodiscard]] bool close(const Plane& a, const Plane& b) const {
    const double cosine = a.normal.dot(b.normal);
    const double side = cosine < 0.0 ? -1.0 : 1.0;
    const double diagonal = boundsOf(points()).diagonal();
    return std::abs(cosine) > 0.995 && std::abs(a.offset - side * b.offset) < 0.01 * diagonal;
  }

  /// Pattern search about a plane: turns about two axes in it and shifts, the step halved when none helps.
  [[nodiscard]] std::pair<Plane, double> refine(const Plane& start) const {
    Vec3 pivot = Vec3::Zero();
    std::size_t count = 0;
    for (PointIndex p : tree_.hullPoints(keyframe_)) {
      pivot += points()[static_cast<std::size_t>(p)];
      ++count;
    }
    pivot /= static_cast<double>(count);
    double extent = 0.0;
    for (PointIndex p : tree_.hullPoints(keyframe_)) {
      extent = std::max(extent, (points()[static_cast<std::size_t>(p)] - pivot).norm());
    }
    pivot -= (start.normal.dot(pivot) - start.offset) * start.normal;
    Plane best = start;
    double bestScore = score(start, kInfinity);
    double angle = 0.2, shift = 0.1 * extent;
    for (int step = 0; step < effort_.refineSteps; ++step) {
      const Vec3 u = best.normal.unitOrthogonal();
      const Vec3 v = best.normal.cross(u);
      std::vector<Plane> around;
      for (const double sign : {1.0, -1.0}) {
        for (const Vec3& axis : {u, v}) {
          const Vec3 normal = (best.normal + sign * std::tan(angle) * axis).normalized();
          around.push_back({normal, normal.dot(pivot)});
        }
        around.push_back({best.normal, best.offset + sign * shift});
      }
      std::vector<double> scores(around.size());
      tbb::parallel_for(std::size_t{0}, around.size(), [&](std::size_t i) { scores[i] = score(around[i], bestScore); });
      const auto winner = std::min_element(scores.begin(), scores.end());
      if (*winner < bestScore) {
        bestScore = *winner;
        best = around[static_cast<std::size_t>(winner - scores.begin())];
        pivot -= (best.normal.dot(pivot) - best.offset) * best.normal;
      } else {
        angle *= 0.5;
        shift *= 0.5;
      }
    }
    return {best, bestScore};
  }

  const Workpiece& piece_;
  std::size_t keyframe_;
  const Workshop& shop_;
  const SplitEffort& effort_;
  PartTree tree_;
};

}  // namespace

std::optional<Split> bestSplit(const Workpiece& piece, std::size_t keyframe, const Workshop& shop,
                               const SplitEffort& effort) {
  return SplitSearch(piece, keyframe, shop, effort).run();
}

}  // namespace lorica
