#include "acd/improve.h"

#include "geometry/convex_hull.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

namespace lorica {
namespace {

// Moves that save less than this fraction of the mesh's volume are not made.
constexpr double kWorthwhile = 2e-4;

class Improver {
 public:
  Improver(std::vector<Piece>& parts, CutContext& context, const ImproveRound& round)
      : parts_(parts), context_(context), round_(round), own_(parts.size()), paired_(parts.size(), false) {
    for (const Piece& part : parts) boxes_.push_back(boxesOf(part, context_));
    for (const double v : context.meshVolume) worthwhile_ += kWorthwhile * std::abs(v);
  }

  /// Makes one move that saves volume. Returns false if there is none.
  bool step() {
    findPairs();
    return exchange() || recut();
  }

  /// Of all parts, over all keyframes.
  [[nodiscard]] double hullVolume() const {
    double volume = 0.0;
    for (const Piece& part : parts_) volume += part.totalHullVolume();
    return volume;
  }

 private:
  /// Two parts that touch.
  struct Pair {
    std::size_t a = 0, b = 0;
    double excess = 0.0;         // hull volume minus volume of both parts: upper bound of the gain of a new cut
    std::optional<double> cost;  // hull volume of the union minus that of both parts, over all keyframes
    bool tried = false;          // whether cutting the union again has failed
  };
  /// The best split of a part.
  struct Own {
    std::optional<Split> split;
    double gain = 0.0;
    bool known = false;
  };

  /// Merges the cheapest pair and cuts the part with the largest gain, if that saves volume.
  bool exchange() {
    measurePairs();
    double cheapest = std::numeric_limits<double>::infinity();
    for (const Pair& pair : pairs_) cheapest = std::min(cheapest, *pair.cost);
    // A part's error bounds its gain, so few parts must be searched, two at a time for any number of threads.
    std::vector<std::size_t> order(parts_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return parts_[a].totalError() > parts_[b].totalError(); });
    double saved = worthwhile_;
    const Pair* best = nullptr;
    std::size_t cut = parts_.size();
    for (std::size_t first = 0; first < order.size(); first += 2) {
      if (parts_[order[first]].totalError() - cheapest <= saved) break;
      const std::span<const std::size_t> here =
          std::span(order).subspan(first, std::min(std::size_t{2}, order.size() - first));
      parallelFor(here.size(), [&](std::size_t i) { searchOwn(here[i]); });
      for (const std::size_t i : here) {
        if (!own_[i].split) continue;
        for (const Pair& pair : pairs_) {
          if (i == pair.a || i == pair.b || own_[i].gain - *pair.cost <= saved) continue;
          saved = own_[i].gain - *pair.cost;
          best = &pair;
          cut = i;
        }
      }
    }
    if (best == nullptr) return false;
    const auto [a, b] = std::pair(best->a, best->b);
    const Split split = *own_[cut].split;
    const Part part = std::move(parts_[cut].part);
    replace(a, join(a, b));
    divide(part, split, cut, b);
    return true;
  }

  /// Cuts unions again, in order of decreasing excess, until a cut saves volume or the patience is used up. Tries two
  /// at a time for any number of threads; if the first one succeeds, the second counts as not tried.
  bool recut() {
    struct Trial {
      Pair* pair;
      Piece joined;
      std::optional<Split> split;
    };
    while (failures_ < round_.patience) {
      std::vector<Trial> trials;
      for (int i = 0; i < 2; ++i) {
        Pair* next = nullptr;
        for (Pair& pair : pairs_) {
          if (!pair.tried && pair.excess > worthwhile_ && (next == nullptr || pair.excess > next->excess)) next = &pair;
        }
        if (next == nullptr) break;
        next->tried = true;
        trials.push_back({next, {}, {}});
      }
      if (trials.empty()) return false;
      parallelFor(trials.size(), [&](std::size_t i) {
        Trial& trial = trials[i];
        const double before = parts_[trial.pair->a].totalHullVolume() + parts_[trial.pair->b].totalHullVolume();
        trial.joined = join(trial.pair->a, trial.pair->b);
        trial.split =
            bestSplit(trial.joined, trial.joined.worstKeyframe(), context_, round_.effort, before - worthwhile_);
      });
      for (Trial& trial : trials) {
        ++failures_;
        const Pair pair = *trial.pair;
        const double before = parts_[pair.a].totalHullVolume() + parts_[pair.b].totalHullVolume();
        if (!trial.split || before - trial.split->hullVolume <= worthwhile_) continue;
        failures_ = 0;
        if (&trial != &trials.back()) trials.back().pair->tried = false;
        divide(trial.joined.part, *trial.split, pair.a, pair.b);
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] bool touch(std::size_t a, std::size_t b) const {
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      if (overlap(boxes_[a][k], boxes_[b][k], context_.onPlane[k])) return true;
    }
    return false;
  }

  [[nodiscard]] Piece join(std::size_t a, std::size_t b) const {
    const std::array<const Part*, 2> both = {&parts_[a].part, &parts_[b].part};
    return measure(unite(both), context_);
  }

  /// Adds the pairs of the parts changed by the last move.
  void findPairs() {
    for (std::size_t a = 0; a < parts_.size(); ++a) {
      for (std::size_t b = a + 1; b < parts_.size(); ++b) {
        if ((paired_[a] && paired_[b]) || !touch(a, b)) continue;
        pairs_.push_back({a, b, parts_[a].totalError() + parts_[b].totalError(), std::nullopt, false});
      }
    }
    paired_.assign(parts_.size(), true);
  }

  /// What it costs to merge each pair.
  void measurePairs() {
    parallelFor(pairs_.size(), [&](std::size_t i) {
      if (!pairs_[i].cost) pairs_[i].cost = costOf(pairs_[i]);
    });
  }

  /// Finds the best split of a part.
  void searchOwn(std::size_t i) {
    Own& own = own_[i];
    if (own.known) return;
    own.known = true;
    if (parts_[i].totalError() <= worthwhile_) return;
    own.split = bestSplit(parts_[i], parts_[i].worstKeyframe(), context_, round_.effort);
    if (own.split) own.gain = parts_[i].totalHullVolume() - own.split->hullVolume;
  }

  [[nodiscard]] double costOf(const Pair& pair) const {
    double volume = 0.0;
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      volume += convexHullVolume(hullPointsOf({&parts_[pair.a], &parts_[pair.b]}, k, context_));
    }
    return volume - parts_[pair.a].totalHullVolume() - parts_[pair.b].totalHullVolume();
  }

  void divide(const Part& part, const Split& split, std::size_t a, std::size_t b) {
    CutResult cut = cutPart(part, context_.points[split.keyframe], split.plane, context_.onPlane[split.keyframe],
                            context_.pointCount());
    context_.addCutPoints(cut.newPoints);
    Piece above, below;
    parallelBoth([&] { above = measure(std::move(cut.above), context_); },
                 [&] { below = measure(std::move(cut.below), context_); });
    replace(a, std::move(above));
    replace(b, std::move(below));
  }

  void replace(std::size_t i, Piece piece) {
    parts_[i] = std::move(piece);
    boxes_[i] = boxesOf(parts_[i], context_);
    own_[i] = {};
    paired_[i] = false;
    std::erase_if(pairs_, [i](const Pair& p) { return p.a == i || p.b == i; });
  }

  std::vector<Piece>& parts_;
  CutContext& context_;
  const ImproveRound& round_;
  std::vector<std::vector<Aabb>> boxes_;  // part, keyframe
  std::vector<Own> own_;
  std::vector<bool> paired_;  // whether a part's pairs are known
  std::vector<Pair> pairs_;
  int failures_ = 0;
  double worthwhile_ = 0.0;
};

}  // namespace

bool improve(std::vector<Piece>& parts, CutContext& context, const ImproveRound& round,
             const std::function<bool()>& goOn) {
  Improver improver(parts, context, round);
  // A move is chosen by what it promises to save. Where keyframes are flat, a cut may not keep that promise, and moves
  // would go round in circles: it ends before the first move that costs volume.
  while (true) {
    if (!goOn()) return false;
    std::vector<Piece> kept = parts;
    const double before = improver.hullVolume();
    if (!improver.step()) return true;
    if (improver.hullVolume() < before) continue;
    parts = std::move(kept);
    return true;
  }
}

}  // namespace lorica
