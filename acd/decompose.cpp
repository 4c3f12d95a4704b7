#include "acd/decompose.h"

#include "acd/concavity.h"
#include "acd/cut.h"
#include "geometry/convex_hull.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

namespace lorica {
namespace {

// Points closer to a candidate plane than this lie on it, relative to the diagonal of the mesh in that keyframe.
constexpr double kOnPlane = 1e-9;
// A part whose hull exceeds it by less than this share of the mesh's volume is convex: there is nothing to gain.
constexpr double kConvex = 1e-9;

/// A part with what the search needs of it in every keyframe.
struct Candidate {
  Part part;
  std::vector<Crease> creases;
  std::vector<double> volume;  // of the part in each keyframe [m^3]
  std::vector<double> hullVolume;
  std::vector<bool> exhausted;  // no plane in this keyframe divides it

  [[nodiscard]] double error(std::size_t k) const { return hullVolume[k] - volume[k]; }
};

class Decomposer {
 public:
  Decomposer(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings)
      : mesh_(mesh), settings_(settings), frameCount_(static_cast<std::size_t>(keyframes.keyframeCount())) {
    for (std::size_t k = 0; k < frameCount_; ++k) {
      const std::span<const Vec3> frame = keyframes.keyframe(static_cast<int>(k));
      points_.emplace_back(frame.begin(), frame.end());
      tolerance_.push_back(kOnPlane * boundsOf(frame).diagonal());
      meshVolume_.push_back(signedVolume(frame, mesh.triangles));
    }
  }

  // Algorithm 3; with one keyframe Algorithm 2.
  Result<Decomposition> run() {
    result_.vertexCount = static_cast<int>(mesh_.vertices.size());
    result_.triangleCount = static_cast<int>(mesh_.triangles.size());
    Part whole;
    whole.triangles = mesh_.triangles;
    whole.sourceTriangle.resize(mesh_.triangles.size());
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) whole.sourceTriangle[i] = static_cast<std::int32_t>(i);
    whole.points = pointsUsedBy(whole.triangles);
    parts_.push_back(measured(std::move(whole)));

    const auto limit =
        settings_.maxParts > 0 ? static_cast<std::size_t>(settings_.maxParts) : std::numeric_limits<std::size_t>::max();
    while (parts_.size() < limit) {
      if (settings_.progress && !settings_.progress(static_cast<int>(parts_.size()), settings_.maxParts)) {
        return Error{ErrorCode::kCancelled, "decomposition cancelled"};
      }
      const auto worst = worstPart();
      if (!worst) break;
      const auto [part, keyframe] = *worst;
      const std::optional<Plane> plane = bestPlane(parts_[part], keyframe);
      if (plane) {
        split(part, keyframe, *plane);
      } else {
        parts_[part].exhausted[keyframe] = true;
      }
    }
    if (settings_.maxParts == 0) separateComponents();
    if (settings_.progress) settings_.progress(static_cast<int>(parts_.size()), settings_.maxParts);
    for (Candidate& c : parts_) result_.parts.push_back(std::move(c.part));
    return std::move(result_);
  }

 private:
  /// Volumes and hull volumes in every keyframe.
  Candidate measured(Part part) const {
    Candidate c;
    c.part = std::move(part);
    c.creases = creasesOf(c.part);
    c.volume.resize(frameCount_);
    c.hullVolume.resize(frameCount_);
    c.exhausted.resize(frameCount_, false);
    tbb::parallel_for(std::size_t{0}, frameCount_, [&](std::size_t k) {
      thread_local std::vector<Vec3> own;
      own.clear();
      for (PointIndex p : c.part.points) own.push_back(points_[k][static_cast<std::size_t>(p)]);
      c.hullVolume[k] = convexHullVolume(own);
      c.volume[k] = signedVolume(points_[k], c.part.triangles);
    });
    return c;
  }

  /// P* and r*: the part and keyframe with the largest error (Eq. 15) that can still be cut.
  std::optional<std::pair<std::size_t, std::size_t>> worstPart() const {
    std::optional<std::pair<std::size_t, std::size_t>> worst;
    double largest = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      for (std::size_t k = 0; k < frameCount_; ++k) {
        if (parts_[i].exhausted[k]) continue;
        const double error = parts_[i].error(k);
        if (error <= kConvex * std::abs(meshVolume_[k]) || error <= largest) continue;
        largest = error;
        worst = {i, k};
      }
    }
    return worst;
  }

  /// The plane that minimises the children's hull volumes over all keyframes (Eq. 14; their meshes' volumes add up to
  /// the parent's, so they drop out). Ties go to the plane tried first.
  std::optional<Plane> bestPlane(const Candidate& c, std::size_t keyframe) const {
    const std::vector<Vec3>& points = points_[keyframe];
    const ConvexHull hull = partHullOf(c.part, points);
    std::vector<Plane> planes;
    for (const ConcaveEdge& edge :
         deepestConcaveEdges(c.creases, mesh_.triangles, points, hull, settings_.candidateEdges)) {
      for (const Plane& plane : planesThrough(edge, settings_.planesPerEdge)) planes.push_back(plane);
    }
    for (const Plane& plane : componentPlanes(c.part, points)) planes.push_back(plane);

    std::vector<double> totals(planes.size());
    std::atomic<double> best = std::numeric_limits<double>::infinity();
    tbb::parallel_for(std::size_t{0}, planes.size(), [&](std::size_t i) {
      totals[i] = hullVolumesAfter(c, keyframe, planes[i], best.load());
      double known = best.load();
      while (totals[i] < known && !best.compare_exchange_weak(known, totals[i])) {
      }
    });
    const auto winner = std::min_element(totals.begin(), totals.end());
    if (winner == totals.end() || std::isinf(*winner)) return std::nullopt;
    return planes[static_cast<std::size_t>(winner - totals.begin())];
  }

  /// Sum of both children's hull volumes over all keyframes; infinity when the plane does not divide the part into two
  /// solids. Gives up, with infinity, once the sum must exceed `toBeat`: hulls hold at least the part itself. The
  /// winner is never given up, so the choice does not depend on the order in which threads finish.
  double hullVolumesAfter(const Candidate& c, std::size_t keyframe, const Plane& plane, double toBeat) const {
    thread_local PlaneSides sides;
    thread_local CutSketch sketch;
    thread_local std::vector<Vec3> own;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (!sketchCut(c.part, points_[keyframe], plane, tolerance_[keyframe], sides, sketch)) return kInfinity;

    const auto childHullVolume = [&](const std::vector<PointIndex>& existing, std::size_t k) {
      const std::vector<Vec3>& points = points_[k];
      own.clear();
      for (PointIndex p : existing) own.push_back(points[static_cast<std::size_t>(p)]);
      for (const CutPoint& cut : sketch.crossings) {
        own.push_back(cut.lambda * points[static_cast<std::size_t>(cut.first)] +
                      (1.0 - cut.lambda) * points[static_cast<std::size_t>(cut.second)]);
      }
      return convexHullVolume(own);
    };
    const double smallest = kConvex * std::abs(meshVolume_[keyframe]);
    double rest = 0.0;
    for (double v : c.volume) rest += v;
    double total = 0.0;
    for (std::size_t i = 0; i < frameCount_; ++i) {
      const std::size_t k = (keyframe + i) % frameCount_;  // the cut's own keyframe first: it refuses flat children
      rest -= c.volume[k];
      const double above = childHullVolume(sketch.above, k);
      const double below = childHullVolume(sketch.below, k);
      if (i == 0 && (above <= smallest || below <= smallest)) return kInfinity;
      total += above + below;
      if (total + std::max(rest, 0.0) * (1.0 - 1e-9) > toBeat * (1.0 + 1e-9)) return kInfinity;
    }
    return total;
  }

  ConvexHull partHullOf(const Part& part, const std::vector<Vec3>& points) const {
    std::vector<Vec3> own;
    own.reserve(part.points.size());
    for (PointIndex p : part.points) own.push_back(points[static_cast<std::size_t>(p)]);
    return convexHull(own);
  }

  /// Cuts a part in one keyframe and carries the new points to all others (Eq. 12).
  void split(std::size_t index, std::size_t keyframe, const Plane& plane) {
    const auto firstNewPoint = static_cast<PointIndex>(points_[0].size());
    CutResult cut = cutPart(parts_[index].part, points_[keyframe], plane, tolerance_[keyframe], firstNewPoint);
    for (std::vector<Vec3>& points : points_) {
      for (const CutPoint& c : cut.newPoints) {
        points.push_back(c.lambda * points[static_cast<std::size_t>(c.first)] +
                         (1.0 - c.lambda) * points[static_cast<std::size_t>(c.second)]);
      }
    }
    result_.cutPoints.insert(result_.cutPoints.end(), cut.newPoints.begin(), cut.newPoints.end());
    result_.cuts.push_back({static_cast<PartIndex>(index), static_cast<int>(keyframe), plane.normal, plane.offset});
    parts_[index] = measured(std::move(cut.above));
    parts_.push_back(measured(std::move(cut.below)));
  }

  /// Algorithm 1, last line: components that no plane could separate become parts of their own. Shells inside out (the
  /// wall of a cavity) stay with the part that they hollow.
  void separateComponents() {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Part& part = parts_[i].part;
      const Components components = connectedComponents(points_[0].size(), part.triangles);
      if (components.count < 2) continue;
      Part first, rest;
      for (std::size_t t = 0; t < part.triangles.size(); ++t) {
        Part& side = components.componentOfTriangle[t] == 0 ? first : rest;
        side.triangles.push_back(part.triangles[t]);
        side.sourceTriangle.push_back(part.sourceTriangle[t]);
      }
      if (signedVolume(points_[0], first.triangles) <= 0.0 || signedVolume(points_[0], rest.triangles) <= 0.0) continue;
      first.points = pointsUsedBy(first.triangles);
      rest.points = pointsUsedBy(rest.triangles);
      result_.cuts.push_back({static_cast<PartIndex>(i), 0, Vec3::Zero(), 0.0});
      parts_[i] = measured(std::move(first));
      parts_.push_back(measured(std::move(rest)));
    }
  }

  const TriMesh& mesh_;
  const DecomposeSettings& settings_;
  std::size_t frameCount_;
  std::vector<std::vector<Vec3>> points_;  // for each keyframe: mesh vertices, then cut points
  std::vector<double> tolerance_;
  std::vector<double> meshVolume_;
  std::vector<Candidate> parts_;
  Decomposition result_;
};

}  // namespace

Result<Decomposition> decompose(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings) {
  if (settings.maxParts < 0 || settings.candidateEdges < 1 || settings.planesPerEdge < 1 || settings.threads < 0) {
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("parts {}, candidate edges {}, planes per edge {}, threads {}: expected parts and threads of 0 "
                    "or more, the others of 1 or more",
                    settings.maxParts, settings.candidateEdges, settings.planesPerEdge, settings.threads)};
  }
  if (static_cast<std::size_t>(keyframes.vertexCount) != mesh.vertices.size() || keyframes.keyframeCount() < 1 ||
      keyframes.positions.size() % mesh.vertices.size() != 0) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} keyframe positions for a mesh of {} vertices: expected one full set or more",
                             keyframes.positions.size(), mesh.vertices.size())};
  }
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    TriMesh posed;
    posed.vertices.assign(keyframes.keyframe(k).begin(), keyframes.keyframe(k).end());
    posed.triangles = mesh.triangles;
    if (Result<void> checked = checkClosedTwoManifold(posed); !checked) {
      Error error = checked.error();
      if (keyframes.keyframeCount() > 1) error.message = fmt::format("keyframe {}: {}", k, error.message);
      return error;
    }
  }
  Decomposer decomposer(mesh, keyframes, settings);
  // More threads than cores are allowed, so that tests can show that the result does not depend on them.
  const std::size_t known = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                    std::max(known, static_cast<std::size_t>(settings.threads)));
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  std::optional<Result<Decomposition>> result;
  arena.execute([&] { result.emplace(decomposer.run()); });
  return std::move(*result);
}

}  // namespace lorica
