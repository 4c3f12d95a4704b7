#include "acd/decomposer.h"

#include "acd/decompose_plan.h"
#include "acd/fewer_parts.h"
#include "acd/hull_distance.h"
#include "acd/merge.h"
#include "acd/part_concavity.h"
#include "acd/piece.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

namespace lorica {
namespace {

// Stop here if the limits cannot be met with a reasonable number of parts.
constexpr std::size_t kMaxPieces = 4096;
// A piece that no plane improves is worth this share of its error: a handle gains only by the cut after the next.
constexpr double kStalled = 0.2;
// A piece is convex where its hull has at most this share of its own volume more. Counting as convex says less of a
// sliver, whose volume is next to nothing, and of two solids that touch: their walls are far from the hull of both.
constexpr double kConvexEnough = 1e-5;
// A component with less than this share of the mesh's volume is a sliver and no cavity, whatever the sign.
constexpr double kNothing = 1e-9;

// So many attempts in a row without fewer parts are enough: of hundreds of parts, each costs as much as of few.
constexpr double kMostPatience = 192.0;

/// Hull volume of all pieces over all keyframes.
double hullVolumeOf(const auto& pieces) {
  double sum = 0.0;
  for (const auto& piece : pieces) sum += piece->totalHullVolume();
  return sum;
}

/// Cuts a mesh into pieces and merges them to parts: Thul et al. 2018, Algorithm 3; with one keyframe Algorithm 2.
class Decomposer {
 public:
  /// @param keyframes  must outlive this object, as must the mesh
  Decomposer(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings, const CutPlan& plan)
      : settings_(settings), cuts_(plan), context_(mesh, keyframes) {
    Part whole;
    whole.triangles = context_.mesh.triangles;
    whole.sourceTriangle.reserve(whole.triangles.size());
    for (std::size_t i = 0; i < whole.triangles.size(); ++i) whole.sourceTriangle.push_back(i);
    whole.points = pointsUsedBy(whole.triangles);
    leaves_.push_back(leafOf(std::move(whole)));
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      firstError_.push_back(leaves_[0].piece->error(k) / std::abs(context_.meshVolume[k]));
    }
    if (settings_.maxParts > 0) counts_ = pieceCounts(settings_.maxParts, cuts_.overCut);
    if (limited()) maxPieces_ = kMaxPieces;
    if (!counts_.empty()) maxPieces_ = counts_.back();
  }

  /// Whether step() has more to do.
  [[nodiscard]] bool going() const { return going_; }
  /// Cuts a piece, if there are fewer than those to which parts can be merged. Returns false if cancelled.
  [[nodiscard]] bool step() {
    if (leaves_.size() >= maxPieces_) {
      going_ = false;
      return true;
    }
    if (!goOn(leaves_.size(), maxPieces_)) return false;
    if (met_ == 0 && limitsMet()) {
      // Cut further, so that merging has alternatives; merging stops while the limits are still met.
      met_ = leaves_.size();
      atLimit_ = piecesNow();
      giveUpAt(cuts_.piecesOnceMet(met_));
      return true;
    }
    if (std::ranges::find(counts_, leaves_.size()) != counts_.end()) stages_.push_back(piecesNow());
    const std::optional<std::size_t> next = cuts_.byGain ? mostGaining() : mostConcave();
    if (!next && partsLimited() && met_ == 0 && separateComponents()) return true;
    going_ = next.has_value();
    if (!next) return true;
    if (leaves_[*next].split->across && !cutsAcross_) {
      cutsAcross_ = true;  // by the next step
    } else {
      carryOut(*next);
    }
    return true;
  }

  [[nodiscard]] std::size_t pieces() const { return leaves_.size(); }
  /// The pieces when the limits were first met; 0 = not yet.
  [[nodiscard]] std::size_t met() const { return met_; }
  /// Stops at so many pieces at the latest.
  void giveUpAt(std::size_t pieces) { maxPieces_ = std::min(maxPieces_, pieces); }

  /// Whether the next step cuts a piece across its longest axis, see SplitEffort::acrossBelow, or one did so before.
  [[nodiscard]] bool cutsAcross() const { return cutsAcross_; }
  /// As this one, but from now on no piece is cut so.
  [[nodiscard]] std::unique_ptr<Decomposer> withoutCutsAcross() const {
    auto other = std::make_unique<Decomposer>(*this);
    other->cuts_.effort.acrossBelow = 0.0;
    for (Leaf& leaf : other->leaves_) {
      if (leaf.split && leaf.split->across) leaf.searched = false;
    }
    return other;
  }

  /// Merges the pieces to at most the requested number of parts. Returns false if cancelled.
  [[nodiscard]] bool merge() {
    if (settings_.maxParts == 0 && !limited()) (void)separateComponents();
    stages_.push_back(piecesNow());
    if (cuts_.overCut <= 1.0) {
      parts_ = stages_.back();
      return true;
    }
    const std::size_t wanted = settings_.maxParts > 0 ? static_cast<std::size_t>(settings_.maxParts) : leaves_.size();
    if (met_ > 0 && settings_.maxError <= 0.0) return mergeByPairs(wanted);
    parts_ = met_ > 0 ? mergedWithinLimits(wanted) : bestMerged(wanted);
    return true;
  }

  /// Whether the limits are met that another misses, or the parts are fewer, or as many and with less hull volume.
  [[nodiscard]] bool betterThan(const Decomposer& other) const {
    if ((met_ > 0) != (other.met_ > 0)) return met_ > 0;
    return betterThan(parts_, other.parts_);
  }

  /// Improves the parts as far as the limits allow. Returns false if cancelled.
  [[nodiscard]] bool improveParts(std::span<const ImproveRound> rounds) {
    if (rounds.empty()) return true;
    std::vector<Piece> pieces;
    pieces.reserve(parts_.size());
    for (const SharedPiece& part : parts_) pieces.push_back(*part);
    const auto tell = [this, count = parts_.size()] { return goOn(count - 1, count); };
    for (const ImproveRound& round : rounds) {
      if (!improve(pieces, context_, round, tell)) return false;
    }
    std::vector<SharedPiece> better;
    better.reserve(pieces.size());
    for (Piece& piece : pieces) better.push_back(std::make_shared<const Piece>(std::move(piece)));
    if (met_ == 0 || limitsMet(better)) parts_ = std::move(better);
    return true;
  }

  /// Sorts the parts by level of detail.
  [[nodiscard]] Decomposition finish() {
    if (settings_.preset != DecomposePreset::kPaper) dropUselessCuts();
    Decomposition result;
    result.vertexCount = countOf(context_.mesh.vertices);
    result.triangleCount = countOf(context_.mesh.triangles);
    if (cuts_.overCut <= 1.0) {
      result.splitFrom = std::move(splitFrom_);
      for (const SharedPiece& part : parts_) result.parts.push_back(part->part);
    } else {
      Merged order = mergePieces(parts_, context_, countOf(parts_), cuts_.effort.coarse);
      result.splitFrom = std::move(order.splitFrom);
      for (const std::vector<std::size_t>& group : order.groups) result.parts.push_back(parts_[group[0]]->part);
    }
    result.cutPoints = std::move(context_.cutPoints);
    (void)goOn(leaves_.size(), leaves_.size());  // the result is complete: it is too late to cancel
    return result;
  }

 private:
  using SharedPiece = std::shared_ptr<const Piece>;
  /// A piece with the best split found for it so far.
  struct Leaf {
    SharedPiece piece;
    std::vector<bool> exhausted;  // keyframes in which no plane divides the piece
    bool searched = false;
    std::optional<Split> split;
    double gain = 0.0;
  };

  /// Whether parts are fewer, or as many and with less hull volume.
  static bool betterThan(std::span<const SharedPiece> parts, std::span<const SharedPiece> others) {
    if (parts.size() != others.size()) return parts.size() < others.size();
    return hullVolumeOf(parts) < hullVolumeOf(others);
  }

  /// Whether there are limits that each part must meet.
  [[nodiscard]] bool partsLimited() const { return settings_.maxDistance > 0.0 || settings_.maxConcavity > 0.0; }
  [[nodiscard]] bool limited() const { return settings_.maxError > 0.0 || partsLimited(); }
  /// Reports progress, scaled to the requested number of parts if more pieces are cut. Without such a number, or with
  /// other limits that may be met earlier, to the one that is expected from how much is done. Returns false to cancel.
  [[nodiscard]] bool goOn(std::size_t pieces, std::size_t limit) const {
    if (!settings_.progress) return true;
    const int most = settings_.maxParts > 0 ? settings_.maxParts : std::numeric_limits<int>::max();
    if (settings_.maxParts > 0 && !limited()) return settings_.progress(pieces * most / limit, most);
    const int parts = std::min<int>(std::ceil(pieces / cuts_.overCut), most);
    if (pieces == limit) return settings_.progress(parts, parts);
    const double done = met_ > 0 ? static_cast<double>(pieces) / limit : shareDone() / cuts_.overCut;
    const int expected = done < 0.01 ? 0 : std::max(parts + 1, static_cast<int>(parts / done));
    return settings_.progress(parts, std::min(expected, most));
  }

  /// How much of the cutting is done in the worst keyframe. On the way to maxError that is told by the logarithm of the
  /// error, which falls like a power of the number of pieces; else by the volume of the pieces that need no more cuts.
  [[nodiscard]] double shareDone() const {
    double least = 1.0;
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      double error = 0.0, finished = 0.0;
      for (const Leaf& leaf : leaves_) {
        error += leaf.piece->error(k) / std::abs(context_.meshVolume[k]);
        const bool near = leaf.piece->excess && *leaf.piece->excess <= 1.0;
        if (!near && !leaf.piece->convex[k] && !leaf.exhausted[k]) continue;
        finished += std::abs(leaf.piece->volume[k] / context_.meshVolume[k]);
      }
      const double wanted = settings_.maxError;
      if (wanted > 0.0 && error > wanted) {
        least = std::min(least, std::log(firstError_[k] / error) / std::log(firstError_[k] / wanted));
      }
      if (partsLimited() || wanted <= 0.0) least = std::min(least, finished);
    }
    return std::clamp(least, 0.0, 1.0);
  }

  /// Whether the hull volume of all pieces meets maxError in every keyframe.
  [[nodiscard]] bool errorMet(std::span<const SharedPiece> pieces) const {
    if (settings_.maxError <= 0.0) return true;
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      double volume = -context_.meshVolume[k];
      for (const SharedPiece& piece : pieces) volume += piece->hullVolume[k];
      if (volume > settings_.maxError * std::abs(context_.meshVolume[k])) return false;
    }
    return true;
  }

  /// The largest distance from the hull of a piece to its surface, or its concavity, in any keyframe, as a multiple of
  /// the limit; whichever is larger. What is below a limit may be reported as up to 1.
  [[nodiscard]] double excessOf(const Piece& piece) const {
    std::vector<double> excess(context_.keyframeCount(), 0.0);
    parallelFor(excess.size(), [&](std::size_t k) {
      if (piece.convex[k] && std::abs(piece.error(k)) <= kConvexEnough * piece.hullVolume[k]) return;
      const ConvexHull hull = convexHull(hullPointsOf({&piece}, k, context_));
      if (const double limit = settings_.maxDistance; limit > 0.0) {
        excess[k] = hullDistance(hull, context_.points[k], piece.part.triangles, limit, limit) / limit;
      }
      if (const double limit = settings_.maxConcavity; limit > 0.0) {
        excess[k] =
            std::max(excess[k], partConcavity(hull, context_.points[k], piece.part.triangles, limit, limit) / limit);
      }
    });
    return *std::max_element(excess.begin(), excess.end());
  }

  [[nodiscard]] bool exceeds(const Piece& piece) const {
    if (!piece.excess) piece.excess = excessOf(piece);
    return *piece.excess > 1.0;
  }

  /// Whether all limits are met.
  [[nodiscard]] bool limitsMet() {
    if (!limited()) return false;
    errorMet_ = errorMet(piecesNow());
    return errorMet_ && (!partsLimited() ||
                         std::none_of(leaves_.begin(), leaves_.end(), [&](Leaf& l) { return exceeds(*l.piece); }));
  }

  [[nodiscard]] bool limitsMet(std::span<const SharedPiece> pieces) const {
    return errorMet(pieces) && (!partsLimited() || std::none_of(pieces.begin(), pieces.end(),
                                                                [&](const SharedPiece& p) { return exceeds(*p); }));
  }

  /// Whether the leaves that exceed a limit of single parts are cut now, all of them and no other.
  [[nodiscard]] bool allAreCut() const { return partsLimited() && met_ == 0 && errorMet_; }

  /// Whether cutting a leaf helps to meet the limits: if only those of single parts are missed, leaves that meet them
  /// are not cut.
  [[nodiscard]] bool worthCutting(const Leaf& leaf) const { return !allAreCut() || exceeds(*leaf.piece); }

  [[nodiscard]] Leaf leafOf(Part part) const {
    Leaf leaf;
    leaf.piece = std::make_shared<const Piece>(measure(std::move(part), context_));
    leaf.exhausted.resize(context_.keyframeCount(), false);
    return leaf;
  }

  /// r*: the keyframe with the largest error among those not exhausted; none if the part is convex. A sliver that
  /// counts as convex is cut as long as it exceeds a limit; several in one part are left to separateComponents().
  [[nodiscard]] std::optional<std::size_t> worstKeyframe(const Leaf& leaf) const {
    const bool sliver =
        partsLimited() && met_ == 0 && std::ranges::find(leaf.piece->convex, true) != leaf.piece->convex.end() &&
        exceeds(*leaf.piece) && connectedComponents(context_.pointCount(), leaf.piece->part.triangles).count < 2;
    std::optional<std::size_t> worst;
    double largest = 0.0;
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      const double error = leaf.piece->error(k);
      if (leaf.exhausted[k] || (leaf.piece->convex[k] && !sliver) || error <= largest) continue;
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
      leaf.split = bestSplit(*leaf.piece, *keyframe, context_, cuts_.effort);
      if (leaf.split) {
        leaf.searched = true;
        leaf.gain = leaf.piece->totalHullVolume() - leaf.split->hullVolume;
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
        if (!k || leaves_[i].piece->error(*k) <= largest || (leaves_[i].searched && !leaves_[i].split)) continue;
        if (!worthCutting(leaves_[i])) continue;
        largest = leaves_[i].piece->error(*k);
        worst = i;
      }
      if (worst && allAreCut()) searchAhead(*worst);
      if (!worst || search(leaves_[*worst])) return worst;
    }
  }

  /// Searches a leaf, and with it those that are probably next, as many as there are threads.
  void searchAhead(std::size_t leaf) {
    std::vector<std::size_t> next;
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      if (!leaves_[i].searched && exceeds(*leaves_[i].piece)) next.push_back(i);
    }
    const auto first = [&](std::size_t i) { return i == leaf ? kInfinity : leaves_[i].piece->totalError(); };
    std::stable_sort(next.begin(), next.end(), [&](std::size_t a, std::size_t b) { return first(a) > first(b); });
    if (next.empty() || next[0] != leaf) return;
    parallelPieces(std::min(next.size(), threadsHere()), [&](std::size_t i) { (void)search(leaves_[next[i]]); });
  }

  /// The part whose best split has the largest gain, or the largest share of its error if it has no gain. A part's
  /// error bounds its gain, so few parts must be searched.
  std::optional<std::size_t> mostGaining() {
    std::vector<std::size_t> order(leaves_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto errorOf = [&](std::size_t i) { return leaves_[i].piece->totalError(); };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return errorOf(a) > errorOf(b); });
    // Search the two parts with the largest errors in parallel; usually both are needed.
    parallelFor(std::min(order.size(), std::size_t{2}), [&](std::size_t i) {
      if (worthCutting(leaves_[order[i]])) search(leaves_[order[i]]);
    });
    std::optional<std::size_t> best;
    double most = 0.0;
    for (const std::size_t i : order) {
      if (best && errorOf(i) <= most) break;
      if (!worthCutting(leaves_[i]) || !search(leaves_[i])) continue;
      const double worth = std::max(leaves_[i].gain, kStalled * errorOf(i));
      if (best && worth <= most) continue;
      most = worth;
      best = i;
    }
    return best;
  }

  void carryOut(std::size_t index) {
    const Split split = *leaves_[index].split;
    CutResult cut = cutPart(leaves_[index].piece->part, context_.points[split.keyframe], split.plane,
                            context_.onPlane[split.keyframe], context_.pointCount());
    context_.addCutPoints(cut.newPoints);
    splitFrom_.push_back(index);
    leaves_.emplace_back();
    const auto become = [&](Leaf& leaf, Part& part) {
      leaf = leafOf(std::move(part));
      if (allAreCut()) (void)exceeds(*leaf.piece);  // asked for sooner or later
    };
    parallelBoth([&] { become(leaves_[index], cut.above); }, [&] { become(leaves_.back(), cut.below); });
  }

  /// Algorithm 1, last line: components that no plane could separate become separate parts; with limits, only where
  /// those of single parts are exceeded. Returns whether there were any. Inside-out shells (the wall of a cavity) stay
  /// in the part that contains the cavity.
  bool separateComponents() {
    bool changed = false;
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      if (limited() && !exceeds(*leaves_[i].piece)) continue;
      const Part& part = leaves_[i].piece->part;
      const Components components = connectedComponents(context_.pointCount(), part.triangles);
      if (components.count < 2) continue;
      Part first, rest;
      for (std::size_t t = 0; t < part.triangles.size(); ++t) {
        Part& side = components.componentOfTriangle[t] == 0 ? first : rest;
        side.triangles.push_back(part.triangles[t]);
        side.sourceTriangle.push_back(part.sourceTriangle[t]);
      }
      const double cavity = limited() ? -kNothing * std::abs(context_.meshVolume[0]) : 0.0;
      if (signedVolume(context_.points[0], first.triangles) <= cavity ||
          signedVolume(context_.points[0], rest.triangles) <= cavity) {
        continue;
      }
      first.points = pointsUsedBy(first.triangles);
      rest.points = pointsUsedBy(rest.triangles);
      splitFrom_.push_back(i);
      leaves_[i] = leafOf(std::move(first));
      leaves_.push_back(leafOf(std::move(rest)));
      changed = true;
    }
    return changed;
  }

  [[nodiscard]] std::vector<SharedPiece> piecesNow() const {
    std::vector<SharedPiece> pieces;
    pieces.reserve(leaves_.size());
    for (const Leaf& leaf : leaves_) pieces.push_back(leaf.piece);
    return pieces;
  }

  /// Merges pieces to the given number of parts.
  [[nodiscard]] std::vector<SharedPiece> merged(std::span<const SharedPiece> pieces, std::size_t count) const {
    std::vector<SharedPiece> parts;
    parts.reserve(count);
    for (const auto& group : mergePieces(pieces, context_, count, cuts_.effort.coarse).groups) {
      std::vector<const Part*> members;
      members.reserve(group.size());
      for (const std::size_t i : group) members.push_back(&pieces[i]->part);
      parts.push_back(members.size() == 1 ? pieces[group[0]]
                                          : std::make_shared<const Piece>(measure(unite(members), context_)));
    }
    return parts;
  }

  /// Merges the pieces of each stage; the parts with the least hull volume.
  [[nodiscard]] std::vector<SharedPiece> bestMerged(std::size_t count) const {
    std::vector<SharedPiece> best;
    double least = std::numeric_limits<double>::infinity();
    for (const std::vector<SharedPiece>& pieces : stages_) {
      std::vector<SharedPiece> parts = merged(pieces, count);
      const double volume = hullVolumeOf(parts);
      if (volume >= least) continue;
      least = volume;
      best = std::move(parts);
    }
    return best;
  }

  /// Merges pairs, and makes two of three, as long as the limits of single parts are met; never more than `max`.
  /// Returns false if cancelled.
  [[nodiscard]] bool mergeByPairs(std::size_t max) {
    const double radius = settings_.maxConcavity / kConcavityVolumeWeight;
    const double maxEmpty = radius > 0.0 ? 4.0 / 3.0 * std::numbers::pi * radius * radius * radius : kInfinity;
    const auto allowed = [&](const Piece& part) { return !exceeds(part); };
    const auto tell = [&] { return goOn(leaves_.size(), leaves_.size()); };
    const auto mergeAllowed = [&](std::vector<SharedPiece>& parts) {
      std::vector<PartIndex> none;
      mergeWithin(parts, none, context_, maxEmpty, allowed);
    };
    std::array<std::vector<SharedPiece>, 2> tried = {atLimit_, stages_.back()};
    // What remains of a surface can be farther from its hull than the whole was.
    if (tried[1].size() == met_ || !limitsMet(tried[1])) tried[1].clear();
    parallelPieces(tried.size(), [&](std::size_t i) { mergeAllowed(tried[i]); });
    parts_ = std::move(tried[!tried[1].empty() && betterThan(tried[1], tried[0])]);
    while (true) {
      const std::size_t before = parts_.size();
      if (!makeFewer(parts_, context_, cuts_.fewerEffort, std::min(cuts_.fewerPatience * before, kMostPatience),
                     allowed, tell))
        return false;
      const std::size_t fewer = parts_.size();
      if (fewer < before) mergeAllowed(parts_);
      if (parts_.size() == fewer) break;
    }
    if (parts_.size() > max) parts_ = merged(stages_.back(), max);
    return true;
  }

  /// Binary search for the fewest parts that meet the limits, assuming that fewer parts are worse; never more than
  /// `max`.
  [[nodiscard]] std::vector<SharedPiece> mergedWithinLimits(std::size_t max) const {
    const std::vector<SharedPiece>& pieces = stages_.back();
    std::size_t kept = atLimit_.size(), broken = 0;
    std::vector<SharedPiece> best = atLimit_;
    while (broken + 1 < kept) {
      const std::size_t count = std::min((broken + kept) / 2, max);
      std::vector<SharedPiece> tried = merged(pieces, count);
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

  /// The number of parts is a limit: cuts that gain nothing in any keyframe are undone, but those that limits need.
  void dropUselessCuts() {
    std::vector<SharedPiece> fewer = parts_;
    std::vector<PartIndex> splitFrom = cuts_.overCut <= 1.0 ? splitFrom_ : std::vector<PartIndex>();
    mergeForFree(fewer, splitFrom, context_, [&](const Piece& common) { return !partsLimited() || !exceeds(common); });
    if (met_ > 0 && !limitsMet(fewer)) return;
    parts_ = std::move(fewer);
    splitFrom_ = std::move(splitFrom);
  }

  DecomposeSettings settings_;
  CutPlan cuts_;
  CutContext context_;
  std::vector<Leaf> leaves_;
  std::vector<double> firstError_;  // of the whole mesh in each keyframe, relative to its volume
  std::vector<PartIndex> splitFrom_;
  std::vector<std::vector<SharedPiece>> stages_;  // the pieces at each of pieceCounts()
  bool going_ = true, cutsAcross_ = false;
  std::vector<std::size_t> counts_;  // of pieces, from which merging is tried
  std::size_t maxPieces_ = std::numeric_limits<std::size_t>::max();
  bool errorMet_ = false;  // by the pieces when limitsMet() was last asked
  std::size_t met_ = 0;    // pieces when the limits were first met; 0 = not yet
  std::vector<SharedPiece>
      atLimit_;  // those pieces: further cuts can increase a hull's distance to its remaining surface
  std::vector<SharedPiece> parts_;
};

/// Cuts and merges. From the first cut across on also without such cuts: the one with fewer pieces goes on, until one
/// meets the limits and the other has more. Returns the better, or nothing if it was cancelled.
std::unique_ptr<Decomposer> divided(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings,
                                    const CutPlan& plan) {
  auto best = std::make_unique<Decomposer>(mesh, keyframes, settings, plan);
  std::unique_ptr<Decomposer> other;
  while (best->going() || (other && other->going())) {
    const bool others = other && other->going() && (!best->going() || other->pieces() < best->pieces());
    Decomposer& now = others ? *other : *best;
    if (!now.step()) return nullptr;
    if (!other && best->cutsAcross()) other = best->withoutCutsAcross();
    if (other && now.met() > 0) {
      (others ? *best : *other).giveUpAt(plan.piecesOnceMet(now.met()));
    }
  }
  if (!best->merge() || (other && !other->merge())) return nullptr;
  return other && other->betterThan(*best) ? std::move(other) : std::move(best);
}

}  // namespace

Result<Decomposition> cutAndMerge(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings) {
  const Error cancelled{ErrorCode::kCancelled, "decomposition cancelled"};
  const Plan plan = planFor(settings);
  const bool both = settings.preset == DecomposePreset::kQuality && plan.cuts.overCut > 1.0;
  DecomposeSettings fast = settings;
  fast.preset = DecomposePreset::kFast;
  const Plan quickPlan = planFor(fast);
  std::unique_ptr<Decomposer> quick;
  if (both) {
    // Progress is that of the careful cuts.
    if (settings.progress) fast.progress = [&](int, int wanted) { return settings.progress(0, wanted); };
    quick = divided(mesh, keyframes, fast, quickPlan.cuts);
    if (!quick) return cancelled;
  }
  const std::unique_ptr<Decomposer> careful = divided(mesh, keyframes, settings, plan.cuts);
  if (!careful) return cancelled;
  // Compared before they are improved: how good improved parts are does not tell where improving leads.
  Decomposer& better = !quick || careful->betterThan(*quick) ? *careful : *quick;
  if (quick && !quick->improveParts(quickPlan.rounds)) return cancelled;
  if (!better.improveParts(plan.rounds)) return cancelled;
  return quick && quick->betterThan(better) ? quick->finish() : better.finish();
}

}  // namespace lorica
