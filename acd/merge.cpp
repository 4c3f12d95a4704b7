#include "acd/merge.h"

#include "geometry/convex_hull.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

namespace lorica {
namespace {

// Merging two parts is free if it adds less than this share of the mesh's volume.
constexpr double kFree = 1e-9;

/// A group of pieces: hull points and boxes in every keyframe, and the sum of its hull volumes.
struct Group {
  std::vector<std::size_t> pieces;
  std::vector<std::vector<Vec3>> hullPoints;
  std::vector<Aabb> box;
  double hullVolume = 0.0;  // over all keyframes
  bool alive = true;
};

/// Adds the hull of a group in the next keyframe.
void addHull(std::span<const Vec3> points, double coarse, Group& group) {
  std::vector<Vec3> outer;
  const HullOutline outline = convexHullOutline(points, coarse);
  for (const VertexIndex i : outline.points) outer.push_back(points[i]);
  group.hullVolume += outline.volume;
  group.box.push_back(boundsOf(outer));
  group.hullPoints.push_back(std::move(outer));
}

Group joined(const Group& a, const Group& b, double coarse) {
  Group g;
  g.pieces = a.pieces;
  g.pieces.insert(g.pieces.end(), b.pieces.begin(), b.pieces.end());
  std::sort(g.pieces.begin(), g.pieces.end());
  for (std::size_t k = 0; k < a.hullPoints.size(); ++k) {
    std::vector<Vec3> points = a.hullPoints[k];
    points.insert(points.end(), b.hullPoints[k].begin(), b.hullPoints[k].end());
    addHull(points, coarse, g);
  }
  return g;
}

double joinedVolume(const Group& a, const Group& b, double coarse, double giveUpAbove) {
  thread_local std::vector<Vec3> points;
  double sum = 0.0;
  for (std::size_t k = 0; k < a.hullPoints.size(); ++k) {
    points = a.hullPoints[k];
    points.insert(points.end(), b.hullPoints[k].begin(), b.hullPoints[k].end());
    sum += convexHullVolume(points, coarse);
    if (sum > giveUpAbove) return std::numeric_limits<double>::infinity();
  }
  return sum;
}

/// Whether the slightly enlarged boxes overlap in some keyframe: only then is a merge likely to be cheap.
bool near(const Group& a, const Group& b) {
  for (std::size_t k = 0; k < a.box.size(); ++k) {
    if (overlap(a.box[k], b.box[k], 0.02 * std::min(a.box[k].diagonal(), b.box[k].diagonal()))) return true;
  }
  return false;
}

/// Two parts that may be merged for free, and the volume that this adds over all keyframes.
struct FreePair {
  std::size_t a = 0, b = 0;
  double cost = kInfinity;
  mutable bool asked = false;                             // whether they may be
  mutable std::shared_ptr<const Piece> common = nullptr;  // if so

  bool operator<(const FreePair& o) const { return std::tie(cost, a, b) < std::tie(o.cost, o.a, o.b); }
};

std::shared_ptr<const Piece> commonPart(const Piece& a, const Piece& b, const CutContext& context) {
  const std::array<const Part*, 2> both = {&a.part, &b.part};
  return std::make_shared<const Piece>(measure(unite(both), context));
}

/// Sets the cost of a pair if its hull is no larger than those of both in any keyframe, or its common part convex.
void price(FreePair& pair, const Piece& a, const Piece& b, const CutContext& context) {
  double cost = 0.0;
  bool exact = true;
  for (std::size_t k = 0; k < context.keyframeCount(); ++k) {
    const std::vector<Vec3> points = hullPointsOf({&a, &b}, k, context);
    const double more = convexHullVolume(points) - a.hullVolume[k] - b.hullVolume[k];
    const double diagonal = boundsOf(points).diagonal();
    if (more > 2.0 * context.noise[k] * diagonal * diagonal) return;  // more than noise can add
    exact = exact && more <= kFree * std::abs(context.meshVolume[k]);
    cost += more;
  }
  if (!exact && !std::ranges::all_of(commonPart(a, b, context)->convex, std::identity())) return;
  pair.cost = cost;
}

/// Merges pairs of touching parts, the cheapest first; of equal pairs the first.
/// @param price   sets the cost of a pair; infinite = never
/// @param allowed  whether a common part may be
void mergePairs(std::vector<std::shared_ptr<const Piece>>& parts, std::vector<PartIndex>& splitFrom,
                const CutContext& context, const auto& price, const auto& allowed) {
  std::vector<std::vector<Aabb>> boxes(parts.size());
  parallelFor(parts.size(), [&](std::size_t i) { boxes[i] = boxesOf(*parts[i], context); });
  const auto touch = [&](std::size_t a, std::size_t b) {
    for (std::size_t k = 0; k < context.keyframeCount(); ++k) {
      if (!overlap(boxes[a][k], boxes[b][k], context.noise[k])) return false;
    }
    return true;
  };
  std::set<FreePair> candidates;
  const auto add = [&](std::vector<FreePair> pairs) {
    parallelFor(pairs.size(), [&](std::size_t i) { price(pairs[i], *parts[pairs[i].a], *parts[pairs[i].b]); });
    for (const FreePair& pair : pairs) {
      if (pair.cost < kInfinity) candidates.insert(pair);
    }
  };
  std::vector<FreePair> pairs;
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = a + 1; b < parts.size(); ++b) {
      if (touch(a, b)) pairs.push_back({a, b});
    }
  }
  add(std::move(pairs));
  std::vector<PartIndex> mergedInto(parts.size(), -1);
  // Common parts are made late: those of all candidates together would be many times the mesh. After a refusal the next
  // ones are probably asked for, too.
  std::size_t ahead = 1;
  while (!candidates.empty()) {
    if (!candidates.begin()->asked) {
      std::vector<const FreePair*> next;
      for (auto pair = candidates.begin(); pair != candidates.end() && next.size() < ahead; ++pair) {
        if (!pair->asked) next.push_back(&*pair);
      }
      parallelPieces(next.size(), [&](std::size_t i) {
        std::shared_ptr<const Piece> common = commonPart(*parts[next[i]->a], *parts[next[i]->b], context);
        if (allowed(*common)) next[i]->common = std::move(common);
        next[i]->asked = true;
      });
    }
    const std::size_t a = candidates.begin()->a, b = candidates.begin()->b;
    std::shared_ptr<const Piece> common = std::move(candidates.begin()->common);
    candidates.erase(candidates.begin());
    ahead = common ? 1 : threadsHere();
    if (!common) continue;
    std::erase_if(candidates, [&](const FreePair& p) { return p.a == a || p.b == a || p.a == b || p.b == b; });
    parts[a] = std::move(common);
    parts[b] = nullptr;
    mergedInto[b] = a;
    boxes[a] = boxesOf(*parts[a], context);
    pairs.clear();
    for (std::size_t other = 0; other < parts.size(); ++other) {
      if (other != a && parts[other] && touch(a, other)) pairs.push_back({std::min(a, other), std::max(a, other)});
    }
    add(std::move(pairs));
  }
  // What was split from a part that is gone is now split from the one that has it. A part is merged into an earlier
  // one, so parts still come after the ones that they were split from.
  std::vector<PartIndex> numberOf(parts.size());
  std::vector<PartIndex> order;
  for (std::size_t i = 0, kept = 0; i < parts.size(); ++i) {
    numberOf[i] = parts[i] ? kept++ : numberOf[mergedInto[i]];
    if (parts[i] && i > 0 && !splitFrom.empty()) order.push_back(numberOf[splitFrom[i - 1]]);
  }
  splitFrom = std::move(order);
  std::erase(parts, nullptr);
}

}  // namespace

void mergeForFree(std::vector<std::shared_ptr<const Piece>>& parts, std::vector<PartIndex>& splitFrom,
                  const CutContext& context, const std::function<bool(const Piece& common)>& allowed) {
  mergePairs(
      parts, splitFrom, context, [&](FreePair& pair, const Piece& a, const Piece& b) { price(pair, a, b, context); },
      allowed);
}

void mergeWithin(std::vector<std::shared_ptr<const Piece>>& parts, std::vector<PartIndex>& splitFrom,
                 const CutContext& context, double maxEmpty, const std::function<bool(const Piece& common)>& allowed) {
  mergePairs(
      parts, splitFrom, context,
      [&](FreePair& pair, const Piece& a, const Piece& b) {
        double cost = 0.0;
        for (std::size_t k = 0; k < context.keyframeCount(); ++k) {
          const double volume = convexHullVolume(hullPointsOf({&a, &b}, k, context));
          if (volume - a.volume[k] - b.volume[k] > maxEmpty) return;
          cost += volume - a.hullVolume[k] - b.hullVolume[k];
        }
        pair.cost = cost;
      },
      allowed);
}

Merged mergePieces(std::span<const std::shared_ptr<const Piece>> pieces, const CutContext& context, int partCount,
                   double coarse) {
  LORICA_CHECK(!pieces.empty() && partCount >= 1, "merging needs at least one piece and leaves at least one part");
  std::vector<Group> groups(pieces.size());
  parallelFor(pieces.size(), [&](std::size_t i) {
    Group& g = groups[i];
    g.pieces = {i};
    for (std::size_t k = 0; k < context.keyframeCount(); ++k) {
      addHull(hullPointsOf({pieces[i].get()}, k, context), coarse, g);
    }
  });

  // Costs of all pairs that are near each other; distant pairs are considered only if no near pair is left.
  struct Pair {
    std::size_t a, b;
    double cost;
  };
  std::vector<Pair> pairs;
  const auto price = [&](std::size_t first) {
    parallelFor(first, pairs.size(), [&](std::size_t i) {
      const Group& a = groups[pairs[i].a];
      const Group& b = groups[pairs[i].b];
      pairs[i].cost = joinedVolume(a, b, coarse, std::numeric_limits<double>::infinity()) - a.hullVolume - b.hullVolume;
    });
  };
  for (std::size_t a = 0; a < groups.size(); ++a) {
    for (std::size_t b = a + 1; b < groups.size(); ++b) {
      if (near(groups[a], groups[b])) pairs.push_back({a, b, 0.0});
    }
  }
  price(0);

  Merged result;
  struct Step {
    std::size_t kept, absorbed;
  };
  std::vector<Step> steps;  // below partCount
  std::vector<std::size_t> atPartCount;
  std::size_t alive = groups.size();
  const auto remember = [&] {
    for (std::size_t i = 0; i < groups.size(); ++i) {
      if (groups[i].alive) {
        atPartCount.push_back(i);
        result.groups.push_back(groups[i].pieces);
      }
    }
  };
  if (alive <= static_cast<std::size_t>(partCount)) remember();
  while (alive > 1) {
    if (pairs.empty()) {
      for (std::size_t a = 0; a < groups.size(); ++a) {
        for (std::size_t b = a + 1; b < groups.size(); ++b) {
          if (groups[a].alive && groups[b].alive) pairs.push_back({a, b, 0.0});
        }
      }
      price(0);
    }
    const Pair best =
        *std::min_element(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.cost < y.cost; });
    groups[best.a] = joined(groups[best.a], groups[best.b], coarse);
    groups[best.b].alive = false;
    --alive;
    std::erase_if(pairs,
                  [&](const Pair& p) { return p.a == best.a || p.b == best.a || p.a == best.b || p.b == best.b; });
    const std::size_t first = pairs.size();
    for (std::size_t other = 0; other < groups.size(); ++other) {
      if (other == best.a || !groups[other].alive || !near(groups[best.a], groups[other])) continue;
      pairs.push_back({std::min(best.a, other), std::max(best.a, other), 0.0});
    }
    price(first);
    if (alive >= static_cast<std::size_t>(partCount)) {
      if (alive == static_cast<std::size_t>(partCount)) remember();
    } else {
      steps.push_back({best.a, best.b});
    }
  }

  // Undo the last merges first: this is the order in which levels of detail add parts.
  std::vector<std::vector<std::size_t>> ordered;
  std::vector<std::size_t> groupOf;  // of part
  groupOf.push_back(steps.empty() ? atPartCount[0] : steps.back().kept);
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const auto parent = std::find(groupOf.begin(), groupOf.end(), step->kept) - groupOf.begin();
    result.splitFrom.push_back(parent);
    groupOf.push_back(step->absorbed);
  }
  for (std::size_t g : groupOf) {
    const auto at = std::find(atPartCount.begin(), atPartCount.end(), g) - atPartCount.begin();
    ordered.push_back(result.groups[at]);
  }
  result.groups = std::move(ordered);
  return result;
}

}  // namespace lorica
