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

// A part whose hull exceeds it by less than this share of the mesh's volume is convex: there is nothing to gain.
constexpr double kConvex = 1e-9;
// A limit that no reasonable number of parts can keep is given up.
constexpr std::size_t kMostParts = 4096;

/// What a preset stands for.
struct Plan {
  SplitEffort effort;
  double overCut = 1.0;     // cut into this many times the parts, then merge the cheapest pairs
  bool byGain = false;      // cut the part that gains most, not the one with the largest error
  SplitEffort trialEffort;  // of the first round of improve()
  int trials = 0;           // unsuccessful trials that end it; 0 = no improvement after merging
  int lastTrials = 0;       // the same for a second round with all effort
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
  // With neither part count nor limit the parts end up convex: there is nothing to merge. One part needs no cut.
  const bool toTheEnd = settings.maxParts == 0 && settings.maxError <= 0.0 && settings.maxDistance <= 0.0;
  if (toTheEnd || settings.maxParts == 1) plan.overCut = 1.0;
  // And planes that pass by the concave edges would shave off crumb after crumb.
  if (toTheEnd) plan.effort.axisPlanes = plan.effort.refinedPlanes = 0;
  return plan;
}

/// Drops cut points that no part needs any more, and numbers the rest anew.
void dropUnusedCutPoints(Decomposition& decomposition) {
  const auto vertexCount = static_cast<std::size_t>(decomposition.vertexCount);
  std::vector<bool> used(static_cast<std::size_t>(decomposition.pointCount()), false);
  for (const Part& part : decomposition.parts) {
    for (const PointIndex p : part.points) used[static_cast<std::size_t>(p)] = true;
  }
  for (std::size_t c = decomposition.cutPoints.size(); c-- > 0;) {
    if (!used[vertexCount + c]) continue;
    used[static_cast<std::size_t>(decomposition.cutPoints[c].first)] = true;
    used[static_cast<std::size_t>(decomposition.cutPoints[c].second)] = true;
  }
  std::vector<PointIndex> numberOf(used.size());
  std::iota(numberOf.begin(), numberOf.begin() + decomposition.vertexCount, 0);
  std::vector<CutPoint> kept;
  kept.reserve(decomposition.cutPoints.size());
  for (std::size_t c = 0; c < decomposition.cutPoints.size(); ++c) {
    if (!used[vertexCount + c]) continue;
    numberOf[vertexCount + c] = decomposition.vertexCount + static_cast<PointIndex>(kept.size());
    CutPoint point = decomposition.cutPoints[c];
    point.first = numberOf[static_cast<std::size_t>(point.first)];
    point.second = numberOf[static_cast<std::size_t>(point.second)];
    kept.push_back(point);
  }
  decomposition.cutPoints = std::move(kept);
  const auto renumber = [&](PointIndex& p) { p = numberOf[static_cast<std::size_t>(p)]; };
  for (Part& part : decomposition.parts) {
    for (Triangle& t : part.triangles) std::for_each(t.begin(), t.end(), renumber);
    std::for_each(part.points.begin(), part.points.end(), renumber);
  }
}

/// A piece with the best split found for it so far.
struct Leaf {
  Workpiece piece;
  std::vector<bool> exhausted;  // keyframes in which no plane divides it
  bool searched = false;
  std::optional<Split> split;
  double gain = 0.0;
  std::optional<double> distance;  // see Decomposer::distanceOf
};

class Decomposer {
 public:
  Decomposer(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings)
      : settings_(settings), plan_(planFor(settings)), shop_(mesh, keyframes) {}

  // Algorithm 3; with one keyframe Algorithm 2.
  Result<Decomposition> run() {
    Part whole;
    whole.triangles = shop_.mesh.triangles;
    whole.sourceTriangle.reserve(whole.triangles.size());
    for (std::size_t i = 0; i < whole.triangles.size(); ++i)
      whole.sourceTriangle.push_back(static_cast<std::int32_t>(i));
    whole.points = pointsUsedBy(whole.triangles);
    leaves_.push_back(leafOf(std::move(whole)));
    std::size_t limit = limited() ? kMostParts : std::numeric_limits<std::size_t>::max();
    if (settings_.maxParts > 0) limit = static_cast<std::size_t>(std::ceil(settings_.maxParts * plan_.overCut));
    while (leaves_.size() < limit) {
      if (!goOn(leaves_.size(), limit)) return cancelled();
      if (met_ == 0 && limitsMet(leaves_)) {
        // Cut some more, so that merging has a choice; it stops where the limits still hold.
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
    (void)goOn(leaves_.size(), leaves_.size());  // the result is there: whoever cancels now is too late
    return result;
  }

 private:
  static Error cancelled() { return {ErrorCode::kCancelled, "decomposition cancelled"}; }
  [[nodiscard]] bool limited() const { return settings_.maxError > 0.0 || settings_.maxDistance > 0.0; }

  /// Tells how far the work is, in parts asked for though more pieces may be cut. False to cancel.
  [[nodiscard]] bool goOn(std::size_t pieces, std::size_t limit) const {
    if (!settings_.progress) return true;
    const std::size_t done =
        settings_.maxParts > 0 ? pieces * static_cast<std::size_t>(settings_.maxParts) / limit : pieces;
    return settings_.progress(static_cast<int>(done), settings_.maxParts);
  }

  /// Whether the hulls of all pieces exceed the mesh by no more than asked for in any keyframe; false when no such
  /// limit was asked for.
  [[nodiscard]] bool errorMet(const auto& pieces, const auto& pieceOf) const {
    if (settings_.maxError <= 0.0) return false;
    for (std::size_t k = 0; k < shop_.keyframeCount(); ++k) {
      double volume = -shop_.meshVolume[k];
      for (const auto& p : pieces) volume += pieceOf(p).hullVolume[k];
      if (volume > settings_.maxError * std::abs(shop_.meshVolume[k])) return false;
    }
    return true;
  }

  /// Largest distance from the hull of a piece to its surface in any keyframe; at most maxDistance where it is less.
  [[nodiscard]] double distanceOf(const Workpiece& piece) const {
    std::vector<double> distances(shop_.keyframeCount());
    tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t k) {
      std::vector<Vec3> corners;
      corners.reserve(piece.hullPoints[k].size());
      for (const PointIndex p : piece.hullPoints[k]) corners.push_back(shop_.points[k][static_cast<std::size_t>(p)]);
      distances[k] = hullDistance(convexHull(corners), shop_.points[k], piece.part.triangles, settings_.maxDistance);
    });
    return *std::max_element(distances.begin(), distances.end());
  }

  [[nodiscard]] bool tooFar(Leaf& leaf) const {
    if (!leaf.distance) leaf.distance = distanceOf(leaf.piece);
    return *leaf.distance > settings_.maxDistance;
  }

  /// Whether a limit that was asked for is kept.
  [[nodiscard]] bool limitsMet(std::vector<Leaf>& leaves) const {
    if (errorMet(leaves, [](const Leaf& l) -> const Workpiece& { return l.piece; })) return true;
    return settings_.maxDistance > 0.0 &&
           std::none_of(leaves.begin(), leaves.end(), [&](Leaf& l) { return tooFar(l); });
  }
  [[nodiscard]] bool limitsMet(const std::vector<Workpiece>& pieces) const {
    if (errorMet(pieces, [](const Workpiece& p) -> const Workpiece& { return p; })) return true;
    return settings_.maxDistance > 0.0 && std::all_of(pieces.begin(), pieces.end(), [&](const Workpiece& p) {
             return distanceOf(p) <= settings_.maxDistance;
           });
  }

  /// Whether cutting a leaf brings the limits closer: where only distance is wanting, those that keep it are left
  /// alone.
  [[nodiscard]] bool worthCutting(Leaf& leaf) const {
    return settings_.maxDistance <= 0.0 || met_ > 0 || settings_.maxError > 0.0 || tooFar(leaf);
  }

  [[nodiscard]] Leaf leafOf(Part part) const {
    Leaf leaf;
    leaf.piece = measure(std::move(part), shop_);
    leaf.exhausted.resize(shop_.keyframeCount(), false);
    return leaf;
  }

  /// r*: the keyframe with the largest error of those that are not exhausted; none when the part is convex.
  std::optional<std::size_t> worstKeyframe(const Leaf& leaf) const {
    std::optional<std::size_t> worst;
    double largest = 0.0;
    for (std::size_t k = 0; k < shop_.keyframeCount(); ++k) {
      const double error = leaf.piece.error(k);
      if (leaf.exhausted[k] || error <= kConvex * std::abs(shop_.meshVolume[k]) || error <= largest) continue;
      largest = error;
      worst = k;
    }
    return worst;
  }

  /// Finds a leaf's best split in its worst keyframe, or in the next worst where no plane divides it.
  bool search(Leaf& leaf) {
    while (!leaf.searched) {
      const auto keyframe = worstKeyframe(leaf);
      if (!keyframe) {
        leaf.searched = true;
        break;
      }
      leaf.split = bestSplit(leaf.piece, *keyframe, shop_, plan_.effort);
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

  /// The part whose best split saves most. A part's error bounds what it can save, so few need to be searched.
  std::optional<std::size_t> mostGaining() {
    std::vector<std::size_t> order(leaves_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return leaves_[a].piece.totalError() > leaves_[b].piece.totalError();
    });
    // The two with the largest errors side by side; most often both have to be searched.
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
    CutResult cut = cutPart(leaves_[index].piece.part, shop_.points[split.keyframe], split.plane,
                            shop_.onPlane[split.keyframe], shop_.pointCount());
    shop_.addCutPoints(cut.newPoints);
    splitFrom_.push_back(static_cast<PartIndex>(index));
    leaves_.emplace_back();
    tbb::parallel_invoke([&] { leaves_[index] = leafOf(std::move(cut.above)); },
                         [&] { leaves_.back() = leafOf(std::move(cut.below)); });
  }

  /// Algorithm 1, last line: components that no plane could separate become parts of their own. Shells inside out (the
  /// wall of a cavity) stay with the part that they hollow.
  void separateComponents() {
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      const Part& part = leaves_[i].piece.part;
      const Components components = connectedComponents(static_cast<std::size_t>(shop_.pointCount()), part.triangles);
      if (components.count < 2) continue;
      Part first, rest;
      for (std::size_t t = 0; t < part.triangles.size(); ++t) {
        Part& side = components.componentOfTriangle[t] == 0 ? first : rest;
        side.triangles.push_back(part.triangles[t]);
        side.sourceTriangle.push_back(part.sourceTriangle[t]);
      }
      if (signedVolume(shop_.points[0], first.triangles) <= 0.0 ||
          signedVolume(shop_.points[0], rest.triangles) <= 0.0) {
        continue;
      }
      first.points = pointsUsedBy(first.triangles);
      rest.points = pointsUsedBy(rest.triangles);
      splitFrom_.push_back(static_cast<PartIndex>(i));
      leaves_[i].piece = measure(std::move(first), shop_);
      leaves_.push_back(leafOf(std::move(rest)));
    }
  }

  /// Merges what was cut too fine, improves it where the plan says so, and brings the parts in their order of detail.
  Result<Decomposition> finish() {
    Decomposition result;
    result.vertexCount = static_cast<int>(shop_.mesh.vertices.size());
    result.triangleCount = static_cast<int>(shop_.mesh.triangles.size());
    if (plan_.overCut <= 1.0) {
      result.splitFrom = std::move(splitFrom_);
      result.parts.reserve(leaves_.size());
      for (Leaf& leaf : leaves_) result.parts.push_back(std::move(leaf.piece.part));
    } else {
      std::vector<Workpiece> pieces;
      pieces.reserve(leaves_.size());
      for (Leaf& leaf : leaves_) pieces.push_back(std::move(leaf.piece));
      const std::size_t wanted = settings_.maxParts > 0 ? static_cast<std::size_t>(settings_.maxParts) : pieces.size();
      pieces = met_ > 0 ? mergedWithinLimits(pieces, wanted) : merged(pieces, wanted);
      if (plan_.trials > 0) {
        const std::size_t count = pieces.size();
        std::vector<Workpiece> better = pieces;
        const auto tell = [&] { return goOn(count - 1, count); };
        if (!improve(better, shop_, plan_.trialEffort, plan_.trials, tell) ||
            !improve(better, shop_, plan_.effort, plan_.lastTrials, tell)) {
          return cancelled();
        }
        if (met_ == 0 || limitsMet(better)) pieces = std::move(better);
      }
      Merged order = mergePieces(pieces, shop_, static_cast<int>(pieces.size()), plan_.effort.coarse);
      result.splitFrom = std::move(order.splitFrom);
      result.parts.reserve(pieces.size());
      for (const std::vector<std::size_t>& group : order.groups) {
        result.parts.push_back(std::move(pieces[group[0]].part));
      }
    }
    result.cutPoints = std::move(shop_.cutPoints);
    dropUnusedCutPoints(result);
    return result;
  }

  [[nodiscard]] std::vector<Workpiece> merged(const std::vector<Workpiece>& pieces, std::size_t count) const {
    std::vector<Workpiece> parts;
    parts.reserve(count);
    for (const auto& group : mergePieces(pieces, shop_, static_cast<int>(count), plan_.effort.coarse).groups) {
      std::vector<const Part*> members;
      members.reserve(group.size());
      for (const std::size_t i : group) members.push_back(&pieces[i].part);
      parts.push_back(members.size() == 1 ? pieces[group[0]] : measure(unite(members), shop_));
    }
    return parts;
  }

  /// The fewest parts that still keep the limits, as far as fewer parts are worse; at most `most` where that is kept.
  [[nodiscard]] std::vector<Workpiece> mergedWithinLimits(const std::vector<Workpiece>& pieces,
                                                          std::size_t most) const {
    std::size_t kept = atLimit_.size(), broken = 0;
    std::vector<Workpiece> best = atLimit_;
    while (broken + 1 < kept) {
      const std::size_t count = std::min((broken + kept) / 2, most);
      std::vector<Workpiece> tried = merged(pieces, count);
      if (limitsMet(tried)) {
        kept = count;
        best = std::move(tried);
      } else if (count >= most) {
        return merged(pieces, most);
      } else {
        broken = count;
      }
    }
    return best.size() > most ? merged(pieces, most) : best;
  }

  const DecomposeSettings& settings_;
  Plan plan_;
  Workshop shop_;
  std::vector<Leaf> leaves_;
  std::vector<PartIndex> splitFrom_;
  std::size_t met_ = 0;             // pieces when the limits were first met; 0 = not yet
  std::vector<Workpiece> atLimit_;  // those pieces: cutting on can take a hull farther from what is left of its surface
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
