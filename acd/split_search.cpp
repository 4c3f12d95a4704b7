#include "acd/split_search.h"

#include "acd/half_volumes.h"
#include "acd/part_tree.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace lorica {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kExact = 1e-10;  // tolerance of a hull, see convexHullVolume()
constexpr double kSolid = 1e-9;   // minimum hull volume of a half, as a fraction of the mesh's volume

constexpr double kFarBetter = 0.1;  // of the error: so much less is worth a cut across an axis that is not the longest

constexpr std::size_t kScoredPoints = 4000;  // of small parts, so many points are at least scored with hulls

/// Of points, the longest last.
Mat3 principalAxesOf(std::span<const Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / countOf(points);
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& p : points) covariance += (p - mean) * (p - mean).transpose();
  return symmetricAxes(covariance).vectors;
}

/// What lies below a plane of triangles that are given by three corners each.
std::vector<Vec3> keptBelow(const Plane& plane, std::span<const Vec3> corners) {
  std::vector<Vec3> kept, polygon, scratch;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    polygon.assign(corners.begin() + i, corners.begin() + i + 3);
    keepBelow(polygon, plane, scratch);
    for (std::size_t c = 2; c < polygon.size(); ++c) kept.insert(kept.end(), {polygon[0], polygon[c - 1], polygon[c]});
  }
  return kept;
}

class SplitSearch {
 public:
  SplitSearch(const Piece& piece, std::size_t keyframe, const CutContext& context, const SplitEffort& effort)
      : piece_(piece), keyframe_(keyframe), context_(context), effort_(effort) {
    for (PointIndex p : piece.hullPoints[keyframe]) hullPoints_.push_back(points()[p]);
  }

  std::optional<Split> run(double toBeat) {
    // The candidate planes are independent of the data structures that score them: build both in parallel.
    std::vector<Plane> planes;
    parallelBoth([&] { planes = candidates(); },
                 [&] {
                   tree_.emplace(piece_.part, context_.points, keyframe_);
                   volumes_.emplace(*tree_, effort_.shortlist == 0);
                   if (effort_.shortlist > 0) estimates_.emplace(*tree_);
                 });
    std::size_t few = planes.size();
    if (estimates_) {
      planes = ranked(planes);
      // Small parts cost so little that many planes can be scored.
      few = std::max<std::size_t>(effort_.shortlist, kScoredPoints / tree_->points(0).size()) + effort_.refinedPlanes;
    }
    // If none of the first planes leaves volume on both sides, try the next ones.
    for (std::size_t first = 0; first < planes.size(); first += few) {
      const std::span<const Plane> here = std::span(planes).subspan(first, std::min(few, planes.size() - first));
      const std::vector<double> scores = scoreAll(here);
      const auto best = std::min_element(scores.begin(), scores.end());
      if (std::isinf(*best)) continue;
      Plane plane = here[best - scores.begin()];
      double least = *best;
      if (refinesLate() && piece_.totalHullVolume() - least < effort_.refineBelow * piece_.totalError()) {
        for (const Plane& start : distinct(planes)) {
          const Plane refined = refine(start);
          const double found = score(refined, least, effort_.balance, effort_.coarse);
          if (found >= least) continue;
          least = found;
          plane = refined;
        }
      }
      bool across = false;
      if (effort_.acrossBelow > 0.0 && piece_.totalHullVolume() - least < effort_.acrossBelow * piece_.totalError()) {
        if (const std::optional<Plane> middle = planeAcross()) {
          plane = *middle;
          across = true;
        }
      }
      // Coarse hulls are no larger than exact ones, and the balance term is at most this.
      if (least - effort_.balance * piece_.totalError() >= toBeat) return std::nullopt;
      return Split{plane, keyframe_, score(plane, kInfinity, 0.0, effort_.exactVolume ? kExact : effort_.coarse),
                   across};
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] const std::vector<Vec3>& points() const { return context_.points[keyframe_]; }

  [[nodiscard]] std::vector<Plane> candidates() const {
    std::vector<Vec3> outer;
    for (VertexIndex v : convexHullOutline(hullPoints_, effort_.coarse).points) {
      outer.push_back(hullPoints_[v]);
    }
    const ConvexHull hull = convexHull(outer);
    const double spacing = effort_.edgeSpacing * boundsOf(hullPoints_).diagonal();
    std::vector<Plane> planes;
    for (const ConcaveEdge& edge :
         deepestConcaveEdges(piece_.creases, context_.mesh.triangles, context_.normals[keyframe_], points(), hull,
                             effort_.candidateEdges, spacing)) {
      for (const Plane& plane : planesThrough(edge, effort_.planesPerEdge)) planes.push_back(plane);
    }
    for (const Plane& plane : componentPlanes(piece_.part, points())) planes.push_back(plane);
    if (effort_.axisPlanes > 0) addAxisPlanes(planes);
    return planes;
  }

  /// Adds evenly spaced planes perpendicular to the coordinate axes, which are those of the mesh's own
  /// frame, to their diagonals and to the principal axes of the hull points.
  void addAxisPlanes(std::vector<Plane>& planes) const {
    const Mat3 own = principalAxesOf(hullPoints_);
    std::vector<Vec3> axes = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    for (int i = 0; i < 3; ++i) {
      const Vec3 axis = own.col(i);
      if (axis.cwiseAbs().maxCoeff() < 0.98) axes.push_back(axis);
    }
    for (const Vec3& axis : axes) addPlanesAcross(hullPoints_, axis, effort_.axisPlanes, planes);
    for (const Vec3& diagonal : diagonals()) addPlanesAcross(hullPoints_, diagonal, effort_.diagonalPlanes, planes);
  }

  /// The plane in the middle across the longest axis, or across another one if that is better by far after one more cut
  /// of both halves: a tube is cut along its axis, although that gains nothing yet. None if no plane divides the piece.
  [[nodiscard]] std::optional<Plane> planeAcross() const {
    const Mat3 axes = principalAxesOf(hullPoints_);
    std::vector<Plane> planes;
    for (const int axis : {2, 1, 0}) addPlanesAcross(hullPoints_, axes.col(axis), 1, planes);
    const std::vector<Vec3> surface = corners();
    std::vector<double> after(planes.size(), kInfinity);
    parallelFor(planes.size(), [&](std::size_t i) {
      if (std::isinf(score(planes[i], kInfinity, 0.0, effort_.coarse))) return;
      after[i] = afterTwoCuts(surface, planes[i]) + (i == 0 ? 0.0 : kFarBetter * piece_.error(keyframe_));
    });
    const auto best = std::min_element(after.begin(), after.end());
    return std::isinf(*best) ? std::nullopt : std::optional(planes[best - after.begin()]);
  }

  /// The corners of the piece's triangles, three each.
  [[nodiscard]] std::vector<Vec3> corners() const {
    std::vector<Vec3> surface;
    surface.reserve(3 * piece_.part.triangles.size());
    for (const Triangle& t : piece_.part.triangles) {
      for (const PointIndex p : t) surface.push_back(points()[p]);
    }
    return surface;
  }

  /// The hull volume of the halves after each is cut again in the middle across one of its axes, if that is less.
  [[nodiscard]] double afterTwoCuts(std::span<const Vec3> surface, const Plane& plane) const {
    double sum = 0.0;
    for (const double side : {1.0, -1.0}) {
      const std::vector<Vec3> half = keptBelow({side * plane.normal, side * plane.offset}, surface);
      std::vector<Vec3> outer;
      const HullOutline outline = convexHullOutline(half, effort_.coarse);
      for (const VertexIndex v : outline.points) outer.push_back(half[v]);
      double least = outline.volume;
      const Mat3 axes = principalAxesOf(outer);
      std::vector<Plane> planes;
      for (int i = 0; i < 3; ++i) addPlanesAcross(outer, axes.col(i), 1, planes);
      for (const auto& [normal, offset] : planes) {
        least = std::min(least, convexHullVolume(keptBelow({normal, offset}, half), effort_.coarse) +
                                    convexHullVolume(keptBelow({-normal, -offset}, half), effort_.coarse));
      }
      sum += least;
    }
    return sum;
  }

  /// Directions to the middles of a cube's edges and to its corners, one of each opposite pair.
  static std::vector<Vec3> diagonals() {
    std::vector<Vec3> found;
    for (int code = 14; code < 27; ++code) {  // x, y and z + 1 are its digits in base 3; 13 is the middle
      const Eigen::Vector3i direction(code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1);
      if (direction.squaredNorm() > 1) found.emplace_back(direction.cast<double>().normalized());
    }
    return found;
  }

  static void addPlanesAcross(std::span<const Vec3> points, const Vec3& axis, int count, std::vector<Plane>& planes) {
    double low = kInfinity, high = -kInfinity;
    for (const Vec3& p : points) {
      low = std::min(low, axis.dot(p));
      high = std::max(high, axis.dot(p));
    }
    for (int i = 1; i <= count; ++i) planes.push_back({axis, low + (high - low) * i / (count + 1)});
  }

  /// Returns the planes that divide the part: the best ones refined unless that comes later, then all, ordered by
  /// estimate.
  [[nodiscard]] std::vector<Plane> ranked(const std::vector<Plane>& planes) const {
    std::vector<double> estimates(planes.size());
    parallelFor(planes.size(), [&](std::size_t i) { estimates[i] = estimate(planes[i]); });
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (!std::isinf(estimates[i])) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return estimates[a] < estimates[b]; });
    std::vector<Plane> result;
    result.reserve(order.size() + effort_.refinedPlanes);
    for (std::size_t i : order) result.push_back(planes[i]);
    if (refinesLate()) return result;
    std::vector<Plane> refined;
    for (const Plane& start : distinct(result)) refined.push_back(refine(start));
    result.insert(result.begin(), refined.begin(), refined.end());
    return result;
  }

  /// Whether planes are refined only if all others gain little.
  [[nodiscard]] bool refinesLate() const { return effort_.refineBelow < 1.0; }

  /// The first planes that differ from each other, as many as are refined.
  [[nodiscard]] std::vector<Plane> distinct(const std::vector<Plane>& planes) const {
    std::vector<Plane> found;
    for (const Plane& plane : planes) {
      if (countOf(found) == effort_.refinedPlanes) break;
      const bool known = std::any_of(found.begin(), found.end(), [&](const Plane& f) { return close(f, plane); });
      if (!known) found.push_back(plane);
    }
    return found;
  }

  /// Estimated sum of both halves' hull volumes over all keyframes, plus the balance term; infinity if the plane does
  /// not divide the part.
  [[nodiscard]] double estimate(const Plane& plane) const {
    thread_local PartTree::Sketch sketch;
    if (!tree_->sketch(plane, context_.onPlane[keyframe_], sketch)) return kInfinity;
    const auto [above, below] = estimates_->volumes(sketch);
    return above + below + effort_.balance * piece_.totalError() * std::abs(above - below) / (above + below);
  }

  /// Scores planes in parallel. A plane that can no longer be the best is abandoned and scores infinity. The best score
  /// so far is updated only after each batch of planes, so that the choice does not depend on which thread finishes
  /// first.
  [[nodiscard]] std::vector<double> scoreAll(std::span<const Plane> planes) const {
    constexpr std::size_t kBatch = 8;
    std::vector<double> scores(planes.size());
    double best = kInfinity;
    for (std::size_t first = 0; first < planes.size(); first += kBatch) {
      const std::size_t last = std::min(first + kBatch, planes.size());
      parallelFor(first, last,
                  [&](std::size_t i) { scores[i] = score(planes[i], best, effort_.balance, effort_.coarse); });
      for (std::size_t i = first; i < last; ++i) best = std::min(best, scores[i]);
    }
    return scores;
  }

  /// Sum of both halves' hull volumes over all keyframes, plus the balance term. Infinity if the plane leaves no volume
  /// on one side, or once the sum is certain to exceed `toBeat`, since hulls are at least as large as the part.
  [[nodiscard]] double score(const Plane& plane, double toBeat, double balance, double tolerance) const {
    thread_local PartTree::Sketch sketch;
    if (!tree_->sketch(plane, context_.onPlane[keyframe_], sketch)) return kInfinity;
    const double smallest = kSolid * std::abs(context_.meshVolume[keyframe_]);
    double rest = std::accumulate(piece_.volume.begin(), piece_.volume.end(), 0.0);
    double total = 0.0, sumAbove = 0.0;
    const std::size_t frameCount = context_.keyframeCount();
    for (std::size_t i = 0; i < frameCount; ++i) {
      const std::size_t k = (keyframe_ + i) % frameCount;  // the plane's keyframe first: it rejects flat halves
      rest -= piece_.volume[k];
      const double above = volumes_->above(sketch, k, tolerance);
      const double below = volumes_->below(sketch, k, tolerance);
      if (i == 0 && (above <= smallest || below <= smallest)) return kInfinity;
      total += above + below;
      sumAbove += above;
      if (total + std::max(rest, 0.0) * (1.0 - 1e-9) > toBeat * (1.0 + 1e-9)) return kInfinity;
    }
    return total + balance * piece_.totalError() * std::abs(2.0 * sumAbove / total - 1.0);
  }

  [[nodiscard]] bool close(const Plane& a, const Plane& b) const {
    const double cosine = a.normal.dot(b.normal);
    const double side = cosine < 0.0 ? -1.0 : 1.0;
    return std::abs(cosine) > 0.995 && std::abs(a.offset - side * b.offset) < 0.01 * boundsOf(hullPoints_).diagonal();
  }

  /// Pattern search around a plane by estimates: rotations about two axes in the plane and shifts; the step is halved
  /// if none improves the estimate.
  [[nodiscard]] Plane refine(const Plane& start) const {
    Vec3 pivot = Vec3::Zero();
    for (const Vec3& p : hullPoints_) pivot += p / countOf(hullPoints_);
    double extent = 0.0;
    for (const Vec3& p : hullPoints_) extent = std::max(extent, (p - pivot).norm());
    pivot -= (start.normal.dot(pivot) - start.offset) * start.normal;
    Plane best = start;
    double bestScore = estimate(start);
    double turn = 0.2, shift = 0.1 * extent;  // `turn` is a tangent
    for (int step = 0; step < effort_.refineSteps; ++step) {
      const Vec3 u = best.normal.unitOrthogonal();
      const Vec3 v = best.normal.cross(u);
      std::vector<Plane> around;
      for (const double sign : {1.0, -1.0}) {
        for (const Vec3& axis : {u, v}) {
          const Vec3 normal = (best.normal + sign * turn * axis).normalized();
          around.push_back({normal, normal.dot(pivot)});
        }
        around.push_back({best.normal, best.offset + sign * shift});
      }
      std::vector<double> scores(around.size());
      parallelFor(around.size(), [&](std::size_t i) { scores[i] = estimate(around[i]); });
      const auto winner = std::min_element(scores.begin(), scores.end());
      if (*winner < bestScore) {
        bestScore = *winner;
        best = around[winner - scores.begin()];
        pivot -= (best.normal.dot(pivot) - best.offset) * best.normal;
      } else {
        turn *= 0.5;
        shift *= 0.5;
      }
    }
    return best;
  }

  const Piece& piece_;
  std::size_t keyframe_;
  const CutContext& context_;
  const SplitEffort& effort_;
  std::optional<PartTree> tree_;
  std::optional<HalfVolumes> volumes_;
  std::optional<HalfEstimates> estimates_;
  std::vector<Vec3> hullPoints_;  // of the part in the keyframe
};

}  // namespace

std::optional<Split> bestSplit(const Piece& piece, std::size_t keyframe, const CutContext& context,
                               const SplitEffort& effort, double toBeat) {
  return SplitSearch(piece, keyframe, context, effort).run(toBeat);
}

}  // namespace lorica
