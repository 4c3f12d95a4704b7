#include "acd/decompose.h"

#include "acd/merge.h"
#include "acd/split_search.h"
#include "acd/workpiece.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lorica {
namespace {

// A part whose hull exceeds it by less than this share of the mesh's volume is convex: there is nothing to gain.
constexpr double kConvex = 1e-9;

/// What a preset stands for.
struct Plan {
  SplitEffort effort;
  double overCut = 1.0;  // cut into this many times the parts, then merge the cheapest pairs
  bool byGain = false;   // cut the part that gains most, not the one with the largest error
};

Plan planFor(const DecomposeSettings& settings) {
  Plan plan;
  switch (settings.preset) {
    case DecomposePreset::kPaper:
      break;
    case DecomposePreset::kFast:
      plan.effort.candidateEdges = 8;
      plan.effort.planesPerEdge = 3;
      plan.effort.edgeSpacing = 0.05;
      plan.effort.axisPlanes = 4;
      plan.effort.coarse = 1e-3;
      plan.overCut = 1.5;
      break;
    case DecomposePreset::kQuality:
      plan.effort.edgeSpacing = 0.05;
      plan.effort.axisPlanes = 8;
      plan.effort.refinedPlanes = 2;
      plan.effort.refineSteps = 8;
      plan.effort.coarse = 1e-3;
      plan.overCut = 2.0;
      plan.byGain = true;
      break;
  }
  if (settings.candidateEdges > 0) plan.effort.candidateEdges = settings.candidateEdges;
  if (settings.planesPerEdge > 0) plan.effort.planesPerEdge = settings.planesPerEdge;
  // One part needs no cut, and with no part count the parts end up convex: there is nothing to merge.
  if (settings.maxParts <= 1) plan.overCut = 1.0;
  return plan;
}

/// A piece with the best split found for it so far.
struct Leaf {
  Workpiece piece;
  std::vector<bool> exhausted;  // keyframes in which no plane divides it
  bool searched = false;
  std::optional<Split> split;
  double gain = 0.0;
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
    addLeaf(std::move(whole));
    const auto limit = settings_.maxParts > 0 ? static_cast<std::size_t>(std::ceil(settings_.maxParts * plan_.overCut))
                                              : std::numeric_limits<std::size_t>::max();
    while (leaves_.size() < limit) {
      if (!goOn(limit)) return Error{ErrorCode::kCancelled, "decomposition cancelled"};
      const std::optional<std::size_t> next = plan_.byGain ? mostGaining() : mostConcave();
      if (!next) break;
      carryOut(*next);
    }
    if (settings_.maxParts == 0) separateComponents();
    (void)goOn(limit);  // the result is there: whoever cancels now is too late
    return finish();
  }

 private:
  /// Tells how far the work is, in parts asked for though more pieces may be cut. False to cancel.
  [[nodiscard]] bool goOn(std::size_t limit) const {
    if (!settings_.progress) return true;
    const std::size_t done =
        settings_.maxParts > 0 ? leaves_.size() * static_cast<std::size_t>(settings_.maxParts) / limit : leaves_.size();
    return settings_.progress(static_cast<int>(done), settings_.maxParts);
  }

  void addLeaf(Part part) {
    Leaf leaf;
    leaf.piece = measure(std::move(part), shop_);
    leaf.exhausted.resize(shop_.keyframeCount(), false);
    leaves_.push_back(std::move(leaf));
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
    std::optional<std::size_t> best;
    for (std::size_t i : order) {
      if (best && leaves_[i].piece.totalError() <= leaves_[*best].gain) break;
      if (!search(leaves_[i])) continue;
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
    addLeaf(std::move(cut.above));
    std::swap(leaves_[index], leaves_.back());
    leaves_.pop_back();
    addLeaf(std::move(cut.below));
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
      addLeaf(std::move(rest));
    }
  }

  Decomposition finish() {
    Decomposition result;
    result.vertexCount = static_cast<int>(shop_.mesh.vertices.size());
    result.triangleCount = static_cast<int>(shop_.mesh.triangles.size());
    result.cutPoints = std::move(shop_.cutPoints);
    if (plan_.overCut <= 1.0) {
      result.splitFrom = std::move(splitFrom_);
      result.parts.reserve(leaves_.size());
      for (Leaf& leaf : leaves_) result.parts.push_back(std::move(leaf.piece.part));
      return result;
    }
    std::vector<Workpiece> pieces;
    pieces.reserve(leaves_.size());
    for (Leaf& leaf : leaves_) pieces.push_back(std::move(leaf.piece));
    Merged merged = mergePieces(pieces, shop_, settings_.maxParts, plan_.effort.coarse);
    result.splitFrom = std::move(merged.splitFrom);
    for (const std::vector<std::size_t>& group : merged.groups) {
      std::vector<const Part*> members;
      members.reserve(group.size());
      for (std::size_t i : group) members.push_back(&pieces[i].part);
      result.parts.push_back(unite(members));
    }
    return result;
  }

  const DecomposeSettings& settings_;
  Plan plan_;
  Workshop shop_;
  std::vector<Leaf> leaves_;
  std::vector<PartIndex> splitFrom_;
};

}  // namespace

Result<Decomposition> decompose(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings) {
  if (settings.maxParts < 0 || settings.candidateEdges < 0 || settings.planesPerEdge < 0 || settings.threads < 0) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("parts {}, candidate edges {}, planes per edge {}, threads {}: expected 0 or more of each",
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
