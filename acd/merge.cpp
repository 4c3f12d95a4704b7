#include "acd/merge.h"

#include "geometry/convex_hull.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace lorica {
namespace {

/// A group of pieces: hull points and boxes in every keyframe, and the sum of its hull volumes.
struct Group {
  std::vector<std::size_t> pieces;
  std::vector<std::vector<Vec3>> hullPoints;
  std::vector<Aabb> box;
  double hullVolume = 0.0;  // over all keyframes
  bool alive = true;
};

Group joined(const Group& a, const Group& b, double coarse) {
  Group g;
  g.pieces = a.pieces;
  g.pieces.insert(g.pieces.end(), b.pieces.begin(), b.pieces.end());
  std::sort(g.pieces.begin(), g.pieces.end());
  for (std::size_t k = 0; k < a.hullPoints.size(); ++k) {
    std::vector<Vec3> points = a.hullPoints[k];
    points.insert(points.end(), b.hullPoints[k].begin(), b.hullPoints[k].end());
    std::vector<Vec3> outer;
    const HullOutline outline = convexHullOutline(points, coarse);
    for (VertexIndex i : outline.points) outer.push_back(points[i]);
    g.hullVolume += outline.volume;
    g.box.push_back(boundsOf(outer));
    g.hullPoints.push_back(std::move(outer));
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
    const double margin = 0.02 * std::min(a.box[k].diagonal(), b.box[k].diagonal());
    if (((a.box[k].min.array() - margin) <= b.box[k].max.array()).all() &&
        ((b.box[k].min.array() - margin) <= a.box[k].max.array()).all()) {
      return true;
    }
  }
  return false;
}

}  // namespace

Merged mergePieces(std::span<const std::shared_ptr<const Piece>> pieces, const CutContext& context, int partCount,
                   double coarse) {
  LORICA_CHECK(!pieces.empty() && partCount >= 1, "merging needs at least one piece and leaves at least one part");
  std::vector<Group> groups(pieces.size());
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
    Group& g = groups[i];
    g.pieces = {i};
    for (std::size_t k = 0; k < context.keyframeCount(); ++k) {
      std::vector<Vec3> own, outer;
      for (PointIndex p : pieces[i]->hullPoints[k]) own.push_back(context.points[k][p]);
      const HullOutline outline = convexHullOutline(own, coarse);
      for (VertexIndex v : outline.points) outer.push_back(own[v]);
      g.hullVolume += outline.volume;
      g.box.push_back(boundsOf(outer));
      g.hullPoints.push_back(std::move(outer));
    }
  });

  // Costs of all pairs that are near each other; distant pairs are considered only if no near pair is left.
  struct Pair {
    std::size_t a, b;
    double cost;
  };
  std::vector<Pair> pairs;
  const auto price = [&](std::size_t first) {
    tbb::parallel_for(first, pairs.size(), [&](std::size_t i) {
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
