#include "acd/half_volumes.h"

#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/threads.h"

namespace lorica {

HalfVolumes::HalfVolumes(const PartTree& tree, bool reduce) : tree_(tree) {
  if (!reduce) return;
  const std::span<const PartTree::Node> nodes = tree.nodes();
  const std::size_t frameCount = tree.keyframeCount();
  hullPoints_.resize(nodes.size() * frameCount);
  // Bottom-up: the hull of a node is computed from the hull points of its children.
  std::vector<int> depth(nodes.size(), 0);
  std::vector<std::vector<std::size_t>> level(1);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const std::size_t own = depth[n];
    if (level.size() <= own) level.resize(own + 1);
    level[own].push_back(n);
    if (nodes[n].second < 0) continue;
    depth[n + 1] = depth[nodes[n].second] = depth[n] + 1;
  }
  for (auto here = level.rbegin(); here != level.rend(); ++here) {
    parallelFor(here->size() * frameCount, [&](std::size_t job) {
      thread_local std::vector<std::int32_t> candidates;
      thread_local std::vector<Vec3> positions;
      const std::size_t n = (*here)[job / frameCount];
      const std::size_t k = job % frameCount;
      std::vector<std::int32_t>& result = hullPoints_[n * frameCount + k];
      if (nodes[n].second < 0) {
        const std::span<const std::int32_t> own = tree.pointsOf(n);
        result.assign(own.begin(), own.end());
        return;
      }
      candidates.clear();
      for (const std::size_t child : {n + 1, static_cast<std::size_t>(nodes[n].second)}) {
        const std::vector<std::int32_t>& own = hullPoints_[child * frameCount + k];
        candidates.insert(candidates.end(), own.begin(), own.end());
      }
      positions.clear();
      for (const std::int32_t p : candidates) positions.push_back(tree.points(k)[p]);
      for (const VertexIndex v : convexHullOutline(positions).points) {
        result.push_back(candidates[v]);
      }
    });
  }
}

double HalfVolumes::above(const PartTree::Sketch& sketch, std::size_t keyframe, double tolerance) const {
  return volume(sketch.above, sketch.crossings, keyframe, tolerance);
}

double HalfVolumes::below(const PartTree::Sketch& sketch, std::size_t keyframe, double tolerance) const {
  return volume(sketch.below, sketch.crossings, keyframe, tolerance);
}

double HalfVolumes::volume(const PartTree::Half& half, const std::vector<CutPoint>& crossings, std::size_t keyframe,
                           double tolerance) const {
  thread_local std::vector<Vec3> own;
  own.clear();
  const std::span<const Vec3> all = tree_.points(keyframe);
  const auto add = [&](std::span<const std::int32_t> points) {
    for (const std::int32_t p : points) own.push_back(all[p]);
  };
  for (const std::int32_t node : half.nodes) {
    add(hullPoints_.empty() ? tree_.pointsOf(node)
                            : hullPoints_[static_cast<std::size_t>(node) * tree_.keyframeCount() + keyframe]);
  }
  add(half.points);
  for (const CutPoint& c : crossings) {
    own.push_back(c.lambda * all[c.first] + (1.0 - c.lambda) * all[c.second]);
  }
  return convexHullVolume(own, tolerance);
}

HalfEstimates::HalfEstimates(const PartTree& tree)
    : tree_(tree), points_(tree.keyframeCount()), scale_(tree.keyframeCount()) {
  const std::span<const PartTree::Node> nodes = tree.nodes();
  supports_.resize(nodes.size() * tree.keyframeCount());
  parallelFor(tree.keyframeCount(), [&](std::size_t k) {
    const std::span<const Vec3> points = tree.points(k);
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : points) mean += p;
    mean /= points.size();
    Mat3 covariance = Mat3::Zero();
    for (const Vec3& p : points) covariance += (p - mean) * (p - mean).transpose();
    const SymmetricAxes solver = symmetricAxes(covariance);
    // Extents along the principal axes, limited so that a flat part is not scaled excessively.
    const Vec3 extent = solver.values.cwiseMax(1e-6 * solver.values[2]).cwiseSqrt();
    const Mat3 round = extent.cwiseInverse().asDiagonal() * solver.vectors.transpose();
    scale_[k] = extent.prod();
    FloatPoints& own = points_[k];
    own.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3f p = (round * (points[i] - mean)).cast<float>();
      own.x[i] = p.x();
      own.y[i] = p.y();
      own.z[i] = p.z();
    }
    parallelRanges(nodes.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        if (nodes[n].second >= 0) continue;
        Support& support = supports_[n * tree.keyframeCount() + k];
        support.clear();
        include(support, own, tree.pointsOf(n), 0, nullptr);
      }
    });
    for (std::size_t n = nodes.size(); n-- > 0;) {
      if (nodes[n].second < 0) continue;
      Support& support = supports_[n * tree.keyframeCount() + k];
      support = supports_[(n + 1) * tree.keyframeCount() + k];
      include(support, supports_[static_cast<std::size_t>(nodes[n].second) * tree.keyframeCount() + k]);
    }
  });
}

std::pair<double, double> HalfEstimates::volumes(const PartTree::Sketch& sketch) const {
  thread_local FloatPoints crossings;
  thread_local std::vector<std::int32_t> ids;
  const std::size_t frameCount = tree_.keyframeCount();
  crossings.resize(sketch.crossings.size());
  while (ids.size() < sketch.crossings.size()) ids.push_back(countOf(ids));
  std::pair<double, double> sum = {0.0, 0.0};
  for (std::size_t k = 0; k < frameCount; ++k) {
    const FloatPoints& points = points_[k];
    for (std::size_t i = 0; i < sketch.crossings.size(); ++i) {
      const CutPoint& c = sketch.crossings[i];
      const std::size_t a = c.first;
      const std::size_t b = c.second;
      const float lambda = c.lambda;
      crossings.x[i] = lambda * points.x[a] + (1.0F - lambda) * points.x[b];
      crossings.y[i] = lambda * points.y[a] + (1.0F - lambda) * points.y[b];
      crossings.z[i] = lambda * points.z[a] + (1.0F - lambda) * points.z[b];
    }
    Support above, below;
    above.clear();
    below.clear();
    for (const std::int32_t n : sketch.above.nodes) {
      include(above, supports_[n * frameCount + k]);
    }
    for (const std::int32_t n : sketch.below.nodes) {
      include(below, supports_[n * frameCount + k]);
    }
    PartTree::CutLeaf before;
    const std::int32_t firstCrossing = points.size();
    for (const PartTree::CutLeaf& leaf : sketch.leaves) {
      const Support& bound = supports_[leaf.node * frameCount + k];
      const auto fresh = std::span(ids).subspan(before.endCrossings, leaf.endCrossings - before.endCrossings);
      include(above, points, std::span(sketch.above.points).subspan(before.endAbove, leaf.endAbove - before.endAbove),
              0, &bound);
      include(above, crossings, fresh, firstCrossing, &bound);
      include(below, points, std::span(sketch.below.points).subspan(before.endBelow, leaf.endBelow - before.endBelow),
              0, &bound);
      include(below, crossings, fresh, firstCrossing, &bound);
      before = leaf;
    }
    sum.first += enclosedVolume(above, points, crossings) * scale_[k];
    sum.second += enclosedVolume(below, points, crossings) * scale_[k];
  }
  return sum;
}

}  // namespace lorica
