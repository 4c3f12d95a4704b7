#include "acd/decompose.h"

#include "acd/hull_distance.h"
#include "acd/improve.h"
#include "acd/merge.h"
#include "acd/piece.h"
#include "acd/split_search.h"
#include "geometry/convex_hull.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace lorica {
namespace {

// A part whose hull volume exceeds its own by less than this fraction of the mesh's volume counts as convex.
constexpr double kConvex = 1e-9;
// Stop here if the limits cannot be met with a reasonable number of parts.
constexpr std::size_t kMaxParts = 4096;

/// The parameters of a preset.
struct Plan {
  SplitEffort effort;
  double overCut = 1.0;     // first cut into this multiple of the part count, then merge the cheapest pairs
  bool byGain = false;      // cut the part with the largest gain, not the one with the largest error
  SplitEffort trialEffort;  // for the first round of improve()
  int trials = 0;           // that round stops after this many failed trials; 0 = do not call improve()
  int lastTrials = 0;       // the same for a second round with full effort
};

Plan planFor(const DecomposeSettings& settings) {
  Plan plan;
  switch (settings.preset) {
    case DecomposePreset::kPaper:
      break;
    case DecomposePreset::kFast:
      plan.effort.candidateEdges = 12;
      plan.effort.edgeSpacing = 0.05;
      plan.effort.axisPlanes = 6;
      plan.effort.shortlist = 2;
      plan.effort.balance = 0.01;
      plan.effort.coarse = 1e-3;
      plan.overCut = 1.5;
      break;
    case DecomposePreset::kQuality:
      plan.effort.candidateEdges = 16;
      plan.effort.edgeSpacing = 0.05;
      plan.effort.axisPlanes = 12;
      plan.effort.refinedPlanes = 3;
      plan.effort.refineSteps = 8;
      plan.effort.shortlist = 4;
      plan.effort.balance = 0.03;
      plan.effort.coarse = 1e-3;
      plan.overCut = 2.0;
      plan.byGain = true;
      plan.trialEffort = plan.effort;
      plan.trialEffort.candidateEdges = 8;
      plan.trialEffort.planesPerEdge = 3;
      plan.trialEffort.axisPlanes = 4;
      plan.trialEffort.refinedPlanes = 1;
      plan.trialEffort.shortlist = 1;
      plan.trials = 12;
      plan.lastTrials = 8;
      break;
  }
  if (settings.candidateEdges > 0) plan.effort.candidateEdges = settings.candidateEdges;
  if (settings.planesPerEdge > 0) plan.effort.planesPerEdge = settings.planesPerEdge;
  // Without part count and limits, cutting goes on until all parts are convex: nothing to merge. One part needs no cut.
  const bool toTheEnd = settings.maxParts == 0 && settings.maxError <= 0.0 && settings.maxDistance <= 0.0;
  if (toTheEnd || settings.maxParts == 1) plan.overCut = 1.0;
  // Planes that do not pass through concave edges would then cut off endlessly many small pieces.
  if (toTheEnd) plan.effort.axisPlanes = plan.effort.refinedPlanes = 0;
  return plan;
}

/// Removes cut points that no part needs any more, and renumbers the rest.
void dropUnusedCutPoints(Decomposition& decomposition) {
  const auto vertexCount = static_cast<std::size_t>(decomposition.vertexCount);
  std::vector<bool> used(static_cast<std::size_t>(decomposition.pointCount()), false);
  for (const Part& part : decomposition.parts) {
    for (const PointIndex p : part.points) used[p] = true;
  }
  for (std::size_t c = decomposition.cutPoints.size(); c-- > 0;) {
    if (!used[vertexCount + c]) continue;
    used[decomposition.cutPoints[c].first] = true;
    used[decomposition.cutPoints[c].second] = true;
  }
  std::vector<PointIndex> numberOf(used.size());
  std::iota(numberOf.begin(), numberOf.begin() + decomposition.vertexCount, 0);
  std::vector<CutPoint> kept;
  kept.reserve(decomposition.cutPoints.size());
  for (std::size_t c = 0; c < decomposition.cutPoints.size(); ++c) {
    if (!used[vertexCount + c]) continue;
    numberOf[vertexCount + c] = decomposition.vertexCount + static_cast<PointIndex>(kept.size());
    CutPoint point = decomposition.cutPoints[c];
    point.first = numberOf[point.first];
    point.second = numberOf[point.second];
    kept.push_back(point);
  }
  decomposition.cutPoints = std::move(kept);
  const auto renumber = [&](PointIndex& p) { p = numberOf[p]; };
  for (Part& part : decomposition.parts) {
    for (Triangle& t : part.triangles) std::for_each(t.begin(), t.end(), renumber);
    std::for_each(part.points.begin(), part.points.end(), renumber);
  }
}

/// A piece with the best split found for it so far.
struct Leaf {
  Piece piece;
  std::vector<bool> exhausted;  // keyframes in which no plane divides the piece
  bool searched = false;
  std::optional<Split> split;
  double gain = 0.0;
  std::optional<double> distance;  // see Decomposer::distanceOf
};

class Decomposer {
 public:
  Decomposer(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings)
      : settings_(settings), plan_(planFor(settings)), context_(mesh, keyframes) {}

  // Algorithm 3; with one keyframe Algorithm 2.
  Result<Decomposition> run() {
    Part whole;
    whole.triangles = context_.mesh.triangles;
    whole.sourceTriangle.reserve(whole.triangles.size());
    for (std::size_t i = 0; i < whole.triangles.size(); ++i)
      whole.sourceTriangle.push_back(static_cast<std::int32_t>(i));
    whole.points = pointsUsedBy(whole.triangles);
    leaves_.push_back(leafOf(std::move(whole)));
    std::size_t limit = limited() ? kMaxParts : std::numeric_limits<std::size_t>::max();
    if (settings_.maxParts > 0) limit = static_cast<std::size_t>(std::ceil(settings_.maxParts * plan_.overCut));
    while (leaves_.size() < limit) {
      if (!goOn(leaves_.size(), limit)) return cancelled();
      if (met_ == 0 && limitsMet(leaves_)) {
        // Cut further, so that merging has alternatives; merging stops while the limits are still met.
        met_ = leaves_.size();
        for (const Leaf& leaf : leaves_) atLimit_.push_back(leaf.piece);
        limit = std::min(limit, static_cast<std::size_t>(std::ceil(static_cast<double>(met_) * plan_.overCut)));
        continue;
      }
      const std::optional<std::size_t> next = plan_.byGain ? mostGaining() : mostConcave();
      if (!next) break;
      carryOut(*next);
    }
    if (settings_.maxParts == 0 && !limited()) separateComponents();
    Result<Decomposition> result = finish();
    (void)goOn(leaves_.size(), leaves_.size());  // the result is complete: it is too late to cancel
    return result;
  }

 private:
  static Error cancelled() { return {ErrorCode::kCancelled, "decomposition cancelled"}; }
  [[nodiscard]] bool limited() const { return settings_.maxError > 0.0 || settings_.maxDistance > 0.0; }

  /// Reports progress, scaled to the requested number of parts if more pieces are cut. Returns false to cancel.
  [[nodiscard]] bool goOn(std::size_t pieces, std::size_t limit) const {
    if (!settings_.progress) return true;
    const std::size_t done =
        settings_.maxParts > 0 ? pieces * static_cast<std::size_t>(settings_.maxParts) / limit : pieces;
    return settings_.progress(static_cast<int>(done), settings_.maxParts);
  }

  /// Whether the hull volume of all pieces meets maxError in every keyframe; false if maxError is not set.
  [[nodiscard]] bool errorMet(const auto& pieces, const auto& pieceOf) const {
    if (settings_.maxError <= 0.0) return false;
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      double volume = -context_.meshVolume[k];
      for (const auto& p : pieces) volume += pieceOf(p).hullVolume[k];
      if (volume > settings_.maxError * std::abs(context_.meshVolume[k])) return false;
    }
    return true;
  }

  /// Largest distance from the hull of a piece to its surface in any keyframe. Distances below maxDistance may be
  /// reported as up to maxDistance.
  [[nodiscard]] double distanceOf(const Piece& piece) const {
    std::vector<double> distances(context_.keyframeCount());
    tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t k) {
      std::vector<Vec3> corners;
      corners.reserve(piece.hullPoints[k].size());
      for (const PointIndex p : piece.hullPoints[k]) corners.push_back(context_.points[k][p]);
      distances[k] = hullDistance(convexHull(corners), context_.points[k], piece.part.triangles, settings_.maxDistance);
    });
    return *std::max_element(distances.begin(), distances.end());
  }

  [[nodiscard]] bool tooFar(Leaf& leaf) const {
    if (!leaf.distance) leaf.distance = distanceOf(leaf.piece);
    return *leaf.distance > settings_.maxDistance;
  }

  /// Whether one of the limits is met.
  [[nodiscard]] bool limitsMet(std::vector<Leaf>& leaves) const {
    if (errorMet(leaves, [](const Leaf& l) -> const Piece& { return l.piece; })) return true;
    return settings_.maxDistance > 0.0 &&
           std::none_of(leaves.begin(), leaves.end(), [&](Leaf& l) { return tooFar(l); });
  }
  [[nodiscard]] bool limitsMet(const std::vector<Piece>& pieces) const {
    if (errorMet(pieces, [](const Piece& p) -> const Piece& { return p; })) return true;
    return settings_.maxDistance > 0.0 && std::all_of(pieces.begin(), pieces.end(), [&](const Piece& p) {
             return distanceOf(p) <= settings_.maxDistance;
           });
  }

  /// Whether cutting a leaf helps to meet the limits: if there is only a distance limit, leaves that meet it are not
  /// cut.
  [[nodiscard]] bool worthCutting(Leaf& leaf) const {
    return settings_.maxDistance <= 0.0 || met_ > 0 || settings_.maxError > 0.0 || tooFar(leaf);
  }

  [[nodiscard]] Leaf leafOf(Part part) const {
    Leaf leaf;
    leaf.piece = measure(std::move(part), context_);
    leaf.exhausted.resize(context_.keyframeCount(), false);
    return leaf;
  }

  /// r*: the keyframe with the largest error among those not exhausted; none if the part is convex.
  std::optional<std::size_t> worstKeyframe(const Leaf& leaf) const {
    std::optional<std::size_t> worst;
    double largest = 0.0;
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      const double error = leaf.piece.error(k);
      if (leaf.exhausted[k] || error <= kConvex * std::abs(context_.meshVolume[k]) || error <= largest) continue;
      largest = error;
      worst = k;
    }
    return worst;
  }

  /// Finds a leaf's best split in its worst keyframe, or in the next worst if no plane divides it there.
  bool search(Leaf& leaf) {
    while (!leaf.searched) {
      const auto keyframe = worstKeyframe(leaf);
      if (!keyframe) {
        leaf.searched = true;
        break;
      }
      leaf.split = bestSplit(leaf.piece, *keyframe, context_, plan_.effort);
      if (leaf.split) {
        leaf.searched = true;
        leaf.gain = leaf.piece.totalHullVolume() - leaf.split->hullVolume;
      } else {
        leaf.exhausted[*keyframe] = true;
      }
    }
    return leaf.split.has_value();
  }

  /// P*: the part with the largest error in any keyframe (Eq. 15) that can still be cut.
  std::optional<std::size_t> mostConcave() {
    while (true) {
      std::optional<std::size_t> worst;
      double largest = 0.0;
      for (std::size_t i = 0; i < leaves_.size(); ++i) {
        const auto k = worstKeyframe(leaves_[i]);
        if (!k || leaves_[i].piece.error(*k) <= largest || (leaves_[i].searched && !leaves_[i].split)) continue;
        if (!worthCutting(leaves_[i])) continue;
        largest = leaves_[i].piece.error(*k);
        worst = i;
      }
      if (!worst || search(leaves_[*worst])) return worst;
    }
  }

  /// The part whose best split has the largest gain. A part's error bounds its gain, so few parts must be searched.
  std::optional<std::size_t> mostGaining() {
    std::vector<std::size_t> order(leaves_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return leaves_[a].piece.totalError() > leaves_[b].piece.totalError();
    });
    // Search the two parts with the largest errors in parallel; usually both are needed.
    tbb::parallel_for(std::size_t{0}, std::min(order.size(), std::size_t{2}), [&](std::size_t i) {
      if (worthCutting(leaves_[order[i]])) search(leaves_[order[i]]);
    });
    std::optional<std::size_t> best;
    for (std::size_t i : order) {
      if (best && leaves_[i].piece.totalError() <= leaves_[*best].gain) break;
      if (!worthCutting(leaves_[i]) || !search(leaves_[i])) continue;
      if (!best || leaves_[i].gain > leaves_[*best].gain) best = i;
    }
    return best;
  }

  void carryOut(std::size_t index) {
    const Split split = *leaves_[index].split;
    CutResult cut = cutPart(leaves_[index].piece.part, context_.points[split.keyframe], split.plane,
                            context_.onPlane[split.keyframe], context_.pointCount());
    context_.addCutPoints(cut.newPoints);
    splitFrom_.push_back(static_cast<PartIndex>(index));
    leaves_.emplace_back();
    tbb::parallel_invoke([&] { leaves_[index] = leafOf(std::move(cut.above)); },
                         [&] { leaves_.back() = leafOf(std::move(cut.below)); });
  }

  /// Algorithm 1, last line: components that no plane could separate become separate parts. Inside-out shells (the wall
  /// of a cavity) stay in the part that contains the cavity.
  void separateComponents() {
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      const Part& part = leaves_[i].piece.part;
      const Components components =
          connectedComponents(static_cast<std::size_t>(context_.pointCount()), part.triangles);
      if (components.count < 2) continue;
      Part first, rest;
      for (std::size_t t = 0; t < part.triangles.size(); ++t) {
        Part& side = components.componentOfTriangle[t] == 0 ? first : rest;
        side.triangles.push_back(part.triangles[t]);
        side.sourceTriangle.push_back(part.sourceTriangle[t]);
      }
      if (signedVolume(context_.points[0], first.triangles) <= 0.0 ||
          signedVolume(context_.points[0], rest.triangles) <= 0.0) {
        continue;
      }
      first.points = pointsUsedBy(first.triangles);
      rest.points = pointsUsedBy(rest.triangles);
      splitFrom_.push_back(static_cast<PartIndex>(i));
      leaves_[i].piece = measure(std::move(first), context_);
      leaves_.push_back(leafOf(std::move(rest)));
    }
  }

  /// Merges pieces down to the requested parts, improves these if the plan requires it, and sorts them by level of
  /// detail.
  Result<Decomposition> finish() {
    Decomposition result;
    result.vertexCount = static_cast<int>(context_.mesh.vertices.size());
    result.triangleCount = static_cast<int>(context_.mesh.triangles.size());
    if (plan_.overCut <= 1.0) {
      result.splitFrom = std::move(splitFrom_);
      result.parts.reserve(leaves_.size());
      for (Leaf& leaf : leaves_) result.parts.push_back(std::move(leaf.piece.part));
    } else {
      std::vector<Piece> pieces;
      pieces.reserve(leaves_.size());
      for (Leaf& leaf : leaves_) pieces.push_back(std::move(leaf.piece));
      const std::size_t wanted = settings_.maxParts > 0 ? static_cast<std::size_t>(settings_.maxParts) : pieces.size();
      pieces = met_ > 0 ? mergedWithinLimits(pieces, wanted) : merged(pieces, wanted);
      if (plan_.trials > 0) {
        const std::size_t count = pieces.size();
        std::vector<Piece> better = pieces;
        const auto tell = [&] { return goOn(count - 1, count); };
        if (!improve(better, context_, plan_.trialEffort, plan_.trials, tell) ||
            !improve(better, context_, plan_.effort, plan_.lastTrials, tell)) {
          return cancelled();
        }
        if (met_ == 0 || limitsMet(better)) pieces = std::move(better);
      }
      Merged order = mergePieces(pieces, context_, static_cast<int>(pieces.size()), plan_.effort.coarse);
      result.splitFrom = std::move(order.splitFrom);
      result.parts.reserve(pieces.size());
      for (const std::vector<std::size_t>& group : order.groups) {
        result.parts.push_back(std::move(pieces[group[0]].part));
      }
    }
    result.cutPoints = std::move(context_.cutPoints);
    dropUnusedCutPoints(result);
    return result;
  }

  [[nodiscard]] std::vector<Piece> merged(const std::vector<Piece>& pieces, std::size_t count) const {
    std::vector<Piece> parts;
    parts.reserve(count);
    for (const auto& group : mergePieces(pieces, context_, static_cast<int>(count), plan_.effort.coarse).groups) {
      std::vector<const Part*> members;
      members.reserve(group.size());
      for (const std::size_t i : group) members.push_back(&pieces[i].part);
      parts.push_back(members.size() == 1 ? pieces[group[0]] : measure(unite(members), context_));
    }
    return parts;
  }

  /// Binary search for the fewest parts that meet the limits, assuming that fewer parts are worse; never more than
  /// `max`.
  [[nodiscard]] std::vector<Piece> mergedWithinLimits(const std::vector<Piece>& pieces, std::size_t max) const {
    std::size_t kept = atLimit_.size(), broken = 0;
    std::vector<Piece> best = atLimit_;
    while (broken + 1 < kept) {
      const std::size_t count = std::min((broken + kept) / 2, max);
      std::vector<Piece> tried = merged(pieces, count);
      if (limitsMet(tried)) {
        kept = count;
        best = std::move(tried);
      } else if (count >= max) {
        return merged(pieces, max);
      } else {
        broken = count;
      }
    }
    return best.size() > max ? merged(pieces, max) : best;
  }

  const DecomposeSettings& settings_;
  Plan plan_;
  CutContext context_;
  std::vector<Leaf> leaves_;
  std::vector<PartIndex> splitFrom_;
  std::size_t met_ = 0;         // pieces when the limits were first met; 0 = not yet
  std::vector<Piece> atLimit_;  // those pieces: further cuts can increase a hull's distance to its remaining surface
};

}  // namespace

Result<Decomposition> decompose(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings) {
  if (settings.maxParts < 0 || settings.candidateEdges < 0 || settings.planesPerEdge < 0 || settings.threads < 0) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("parts {}, candidate edges {}, planes per edge {}, threads {}: expected 0 or more of each",
                             settings.maxParts, settings.candidateEdges, settings.planesPerEdge, settings.threads)};
  }
  if (!(settings.maxError >= 0.0 && settings.maxDistance >= 0.0)) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("max error {}, max distance {}: expected 0 or more of each",
                                                          settings.maxError, settings.maxDistance)};
  }
  if (static_cast<std::size_t>(keyframes.vertexCount) != mesh.vertices.size() || keyframes.keyframeCount() < 1 ||
      keyframes.positions.size() % mesh.vertices.size() != 0) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} keyframe positions for a mesh of {} vertices: expected a positive multiple",
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
  // Allow more threads than cores, so that tests can verify that the result does not depend on the number.
  const std::size_t known = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                    std::max(known, static_cast<std::size_t>(settings.threads)));
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  std::optional<Result<Decomposition>> result;
  arena.execute([&] { result.emplace(decomposer.run()); });
  return std::move(*result);
}

}  // namespace lorica
