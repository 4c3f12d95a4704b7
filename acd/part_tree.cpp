#include "acd/part_tree.h"

#include "geometry/convex_hull.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace lorica {
namespace {

constexpr std::int32_t kLeafTriangles = 64;

}  // namespace

PartTree::PartTree(const Part& part, std::span<const std::vector<Vec3>> keyframes, std::size_t keyframe,
                   double tolerance)
    : part_(part), keyframes_(keyframes), keyframe_(keyframe) {
  buildNodes();
  const std::size_t frameCount = keyframes.size();
  hullPoints_.resize(nodes_.size() * frameCount);
  int deepest = 0;
  for (const Node& node : nodes_) deepest = std::max(deepest, node.depth);
  // From the leaves upwards: the hull of a node comes from the hull points of its children.
  std::vector<std::vector<std::int32_t>> level(static_cast<std::size_t>(deepest) + 1);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    level[static_cast<std::size_t>(nodes_[i].depth)].push_back(static_cast<std::int32_t>(i));
  }
  for (int depth = deepest; depth >= 0; --depth) {
    const std::vector<std::int32_t>& here = level[static_cast<std::size_t>(depth)];
    tbb::parallel_for(std::size_t{0}, here.size() * frameCount, [&](std::size_t job) {
      thread_local std::vector<PointIndex> candidates;
      thread_local std::vector<Vec3> positions;
      const std::int32_t index = here[job / frameCount];
      const std::size_t k = job % frameCount;
      const Node& node = nodes_[static_cast<std::size_t>(index)];
      candidates.clear();
      if (node.child < 0) {
        for (std::int32_t i = node.first; i < node.last; ++i) {
          const Triangle& t = part_.triangles[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])];
          candidates.insert(candidates.end(), t.begin(), t.end());
        }
      } else {
        for (std::int32_t c : {node.child, node.child + 1}) {
          const auto& own = hullPoints_[static_cast<std::size_t>(c) * frameCount + k];
          candidates.insert(candidates.end(), own.begin(), own.end());
        }
      }
      std::sort(candidates.begin(), candidates.end());
      candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
      std::vector<PointIndex>& result = hullPoints_[static_cast<std::size_t>(index) * frameCount + k];
      if (node.child < 0) {
        result = candidates;
        return;
      }
      positions.clear();
      for (PointIndex p : candidates) positions.push_back(keyframes_[k][static_cast<std::size_t>(p)]);
      for (VertexIndex v : convexHullPoints(positions, tolerance)) {
        result.push_back(candidates[static_cast<std::size_t>(v)]);
      }
    });
  }
}

void PartTree::buildNodes() {
  const std::vector<Vec3>& points = keyframes_[keyframe_];
  std::vector<Vec3> center(part_.triangles.size());
  for (std::size_t i = 0; i < center.size(); ++i) {
    const Triangle& t = part_.triangles[i];
    center[i] = points[static_cast<std::size_t>(t[0])] + points[static_cast<std::size_t>(t[1])] +
                points[static_cast<std::size_t>(t[2])];
  }
  order_.resize(part_.triangles.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.push_back({{}, 0, static_cast<std::int32_t>(order_.size()), -1, 0});
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node node = nodes_[i];
    Aabb centers;
    for (std::int32_t j = node.first; j < node.last; ++j) {
      const auto triangle = static_cast<std::size_t>(order_[static_cast<std::size_t>(j)]);
      for (PointIndex p : part_.triangles[triangle]) node.box.extend(points[static_cast<std::size_t>(p)]);
      centers.extend(center[triangle]);
    }
    if (node.last - node.first > kLeafTriangles) {
      int axis = 0;
      (centers.max - centers.min).maxCoeff(&axis);
      const std::int32_t middle = (node.first + node.last) / 2;
      std::nth_element(order_.begin() + node.first, order_.begin() + middle, order_.begin() + node.last,
                       [&](std::int32_t a, std::int32_t b) {
                         const double ca = center[static_cast<std::size_t>(a)][axis];
                         const double cb = center[static_cast<std::size_t>(b)][axis];
                         return ca != cb ? ca < cb : a < b;
                       });
      node.child = static_cast<std::int32_t>(nodes_.size());
      nodes_.push_back({{}, node.first, middle, -1, node.depth + 1});
      nodes_.push_back({{}, middle, node.last, -1, node.depth + 1});
    }
    nodes_[i] = node;
  }
}

bool PartTree::sketch(const Plane& plane, double tolerance, PlaneSides& sides, Sketch& out) const {
  out.nodesAbove.clear();
  out.nodesBelow.clear();
  out.pointsAbove.clear();
  out.pointsBelow.clear();
  out.crossings.clear();
  const std::vector<Vec3>& points = keyframes_[keyframe_];
  bool anyAbove = false, anyBelow = false;
  std::array<std::int32_t, 128> stack;
  int height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const std::int32_t index = stack[--height];
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    const Vec3 half = 0.5 * (node.box.max - node.box.min);
    const double middle = plane.normal.dot(node.box.center()) - plane.offset;
    const double reach = plane.normal.cwiseAbs().dot(half) + tolerance;
    if (middle > reach) {
      out.nodesAbove.push_back(index);
      anyAbove = true;
      continue;
    }
    if (middle < -reach) {
      out.nodesBelow.push_back(index);
      anyBelow = true;
      continue;
    }
    if (node.child >= 0) {
      stack[height++] = node.child + 1;
      stack[height++] = node.child;
      continue;
    }
    for (std::int32_t i = node.first; i < node.last; ++i) {
      const Triangle& t = part_.triangles[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])];
      std::array<int, 3> s{};
      for (int c = 0; c < 3; ++c) s[c] = sides.classify(t[c], points, plane, tolerance);
      const int low = std::min({s[0], s[1], s[2]});
      const int high = std::max({s[0], s[1], s[2]});
      const int flatSide = low == 0 && high == 0 ? sides.sideOf(t, points, plane) : 0;
      anyAbove |= high > 0;
      anyBelow |= low < 0;
      for (int c = 0; c < 3; ++c) {
        if (s[c] >= 0 && (high > 0 || flatSide > 0)) out.pointsAbove.push_back(t[c]);
        if (s[c] <= 0 && (low < 0 || flatSide < 0)) out.pointsBelow.push_back(t[c]);
        // Each edge runs once each way in a closed part: take it where it ascends.
        const int d = (c + 1) % 3;
        if (s[c] * s[d] < 0 && t[c] < t[d]) out.crossings.push_back(sides.crossing(t[c], t[d]));
      }
    }
  }
  if (!anyAbove || !anyBelow) return false;
  for (std::vector<PointIndex>* list : {&out.pointsAbove, &out.pointsBelow}) {
    std::sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  return true;
}

void PartTree::gatherAbove(const Sketch& s, std::size_t keyframe, std::vector<Vec3>& points) const {
  gather(s.nodesAbove, s.pointsAbove, s.crossings, keyframe, points);
}

void PartTree::gatherBelow(const Sketch& s, std::size_t keyframe, std::vector<Vec3>& points) const {
  gather(s.nodesBelow, s.pointsBelow, s.crossings, keyframe, points);
}

void PartTree::gather(const std::vector<std::int32_t>& nodes, const std::vector<PointIndex>& single,
                      const std::vector<CutPoint>& crossings, std::size_t keyframe, std::vector<Vec3>& points) const {
  const std::vector<Vec3>& all = keyframes_[keyframe];
  points.clear();
  for (std::int32_t node : nodes) {
    for (PointIndex p : hullPoints_[static_cast<std::size_t>(node) * keyframes_.size() + keyframe]) {
      points.push_back(all[static_cast<std::size_t>(p)]);
    }
  }
  for (PointIndex p : single) points.push_back(all[static_cast<std::size_t>(p)]);
  for (const CutPoint& c : crossings) {
    points.push_back(c.lambda * all[static_cast<std::size_t>(c.first)] +
                     (1.0 - c.lambda) * all[static_cast<std::size_t>(c.second)]);
  }
}

}  // namespace lorica
