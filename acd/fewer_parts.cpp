#include "acd/fewer_parts.h"

#include "geometry/convex_hull.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

namespace lorica {
namespace {

using SharedPiece = std::shared_ptr<const Piece>;

constexpr std::size_t kTogether = 2;  // searches at a time, for any number of threads
constexpr int kShifts = 1;            // of a plane that leaves one half too large and the other small enough
constexpr double kNearly = 1.02;      // no shift if both halves are expected to exceed the limit by more

/// A part and two others that it touches.
struct Triple {
  std::array<std::size_t, 3> parts{};
  double empty = 0.0;  // share of the mesh's volume that their hull has more than they, in the worst keyframe
  bool tried = false;
};

bool shareAPoint(const Part& a, const Part& b) {
  for (auto p = a.points.begin(), q = b.points.begin(); p != a.points.end() && q != b.points.end();) {
    if (*p == *q) return true;
    (*p < *q ? p : q)++;
  }
  return false;
}

class FewerParts {
 public:
  FewerParts(std::vector<SharedPiece>& parts, CutContext& context, const SplitEffort& effort,
             const std::function<bool(const Piece& part)>& allowed)
      : parts_(parts), context_(context), effort_(effort), allowed_(allowed), touched_(parts.size()) {
    for (std::size_t i = 0; i < parts.size(); ++i) changed_.push_back(i);
  }

  /// Tries the next triples. Returns the number of attempts until the first that succeeded, or of all; 0 = none is
  /// left.
  int step(bool& fewer) {
    findTriples();
    std::vector<Triple*> next;
    for (Triple& triple : triples_) {
      if (!triple.tried && next.size() < kTogether) next.push_back(&triple);
    }
    std::vector<std::pair<Piece, std::optional<Split>>> unions(next.size());
    parallelPieces(next.size(), [&](std::size_t i) {
      std::array<const Part*, 3> members{};
      for (std::size_t m = 0; m < members.size(); ++m) members[m] = &parts_[next[i]->parts[m]]->part;
      Piece& joined = unions[i].first;
      joined = measure(unite(members), context_);
      unions[i].second = bestSplit(joined, joined.worstKeyframe(), context_, effort_);
    });
    int attempts = 0;
    for (std::size_t i = 0; i < next.size() && !fewer; ++i) {
      ++attempts;
      next[i]->tried = true;
      fewer = unions[i].second && divide(next[i]->parts, unions[i].first, *unions[i].second);
    }
    return attempts;
  }

 private:
  /// The triples of the parts that the last step changed, those with the least empty volume first.
  void findTriples() {
    if (changed_.empty()) return;
    const auto changed = [&](std::size_t i) { return std::ranges::find(changed_, i) != changed_.end(); };
    std::erase_if(triples_, [&](const Triple& t) { return std::ranges::any_of(t.parts, changed); });
    for (std::vector<std::size_t>& others : touched_) std::erase_if(others, changed);
    for (const std::size_t a : changed_) touched_[a].clear();
    for (const std::size_t a : changed_) {
      for (std::size_t b = 0; b < parts_.size(); ++b) {
        if (a == b || !parts_[a] || !parts_[b] || (b < a && changed(b))) continue;
        if (!shareAPoint(parts_[a]->part, parts_[b]->part)) continue;
        touched_[a].push_back(b);
        touched_[b].push_back(a);
      }
    }
    const std::size_t known = triples_.size();
    for (std::size_t middle = 0; middle < parts_.size(); ++middle) {
      std::ranges::sort(touched_[middle]);
      for (const std::size_t a : touched_[middle]) {
        for (const std::size_t b : touched_[middle]) {
          if (b <= a || !(changed(middle) || changed(a) || changed(b))) continue;
          const bool all = std::ranges::find(touched_[a], b) != touched_[a].end();
          if (!all || middle < a) triples_.push_back({{middle, a, b}});
        }
      }
    }
    parallelFor(triples_.size() - known, [&](std::size_t i) { measureEmpty(triples_[known + i]); });
    std::ranges::stable_sort(triples_, {}, [](const Triple& t) { return t.empty; });
    changed_.clear();
  }

  void measureEmpty(Triple& triple) const {
    const auto& [a, b, c] = triple.parts;
    for (std::size_t k = 0; k < context_.keyframeCount(); ++k) {
      const double volume = parts_[a]->volume[k] + parts_[b]->volume[k] + parts_[c]->volume[k];
      const double around =
          convexHullVolume(hullPointsOf({parts_[a].get(), parts_[b].get(), parts_[c].get()}, k, context_));
      triple.empty = std::max(triple.empty, (around - volume) / std::abs(context_.meshVolume[k]));
    }
  }

  /// Cuts a union, and once more elsewhere if only one half is allowed. Returns whether both are, and if so keeps them.
  bool divide(const std::array<std::size_t, 3>& members, const Piece& joined, Split split) {
    for (int shifts = 0;; ++shifts) {
      CutResult cut = cutPart(joined.part, context_.points[split.keyframe], split.plane,
                              context_.onPlane[split.keyframe], context_.pointCount());
      if (cut.above.triangles.empty() || cut.below.triangles.empty()) return false;
      context_.addCutPoints(cut.newPoints);
      SharedPiece above, below;
      bool aboveAllowed = false, belowAllowed = false;
      const auto become = [&](Part& part, SharedPiece& piece, bool& isAllowed) {
        piece = std::make_shared<const Piece>(measure(std::move(part), context_));
        isAllowed = allowed_(*piece);
      };
      parallelBoth([&] { become(cut.above, above, aboveAllowed); }, [&] { become(cut.below, below, belowAllowed); });
      if (aboveAllowed && belowAllowed) {
        parts_[members[0]] = std::move(above);
        parts_[members[1]] = std::move(below);
        parts_[members[2]] = nullptr;
        changed_.assign(members.begin(), members.end());
        return true;
      }
      if (shifts == kShifts || aboveAllowed == belowAllowed || !shift(split, joined, *above, *below)) return false;
    }
  }

  /// Moves a plane to where both halves are expected to exceed the limit equally, if that is not by much: what is round
  /// exceeds it by the square of its width.
  [[nodiscard]] bool shift(Split& split, const Piece& joined, const Piece& above, const Piece& below) const {
    constexpr double kLeast = 0.01;
    double low = kInfinity, high = -kInfinity;
    for (const PointIndex p : joined.hullPoints[split.keyframe]) {
      const double along = split.plane.normal.dot(context_.points[split.keyframe][p]);
      low = std::min(low, along);
      high = std::max(high, along);
    }
    const double up = std::sqrt(std::max(*above.excess, kLeast)) / (high - split.plane.offset);
    const double down = std::sqrt(std::max(*below.excess, kLeast)) / (split.plane.offset - low);
    const double offset = (up * high + down * low) / (up + down);
    if (up * (high - offset) > kNearly) return false;
    split.plane.offset = offset;
    return true;
  }

  std::vector<SharedPiece>& parts_;
  CutContext& context_;
  const SplitEffort& effort_;
  const std::function<bool(const Piece& part)>& allowed_;
  std::vector<Triple> triples_;
  std::vector<std::vector<std::size_t>> touched_;  // by each part
  std::vector<std::size_t> changed_;               // parts since triples were last found
};

}  // namespace

bool makeFewer(std::vector<SharedPiece>& parts, CutContext& context, const SplitEffort& effort, double patience,
               const std::function<bool(const Piece& part)>& allowed, const std::function<bool()>& goOn) {
  FewerParts search(parts, context, effort, allowed);
  for (int failures = 0; failures < patience;) {
    if (!goOn()) return false;
    bool fewer = false;
    const int attempts = search.step(fewer);
    if (attempts == 0) break;
    failures = fewer ? 0 : failures + attempts;
  }
  std::erase(parts, nullptr);
  return true;
}

}  // namespace lorica
