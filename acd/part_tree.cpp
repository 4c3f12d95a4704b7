#include "acd/part_tree.h"

#include "geometry/counts.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>

namespace lorica {
namespace {

constexpr std::size_t kLeafTriangles = 32;
constexpr std::size_t kSerialTriangles = 4096;  // nodes with at most this many triangles are built by one thread

/// Number of nodes in the hierarchy over the given number of triangles.
std::int32_t nodeCount(std::size_t triangles) {
  if (triangles <= kLeafTriangles) return 1;
  return 1 + nodeCount(triangles / 2) + nodeCount(triangles - triangles / 2);
}

}  // namespace

PartTree::PartTree(const Part& part, std::span<const std::vector<Vec3>> keyframes, std::size_t keyframe)
    : keyframe_(keyframe) {
  const std::vector<Vec3>& all = keyframes[keyframe];
  const std::size_t count = part.triangles.size();
  const Vec3 origin = count == 0 ? Vec3(0, 0, 0) : all[part.triangles[0][0]];
  std::vector<Item> items(count);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 sum = -3.0 * origin;
    for (PointIndex p : part.triangles[i]) sum += all[p];
    items[i] = {sum.cast<float>(), static_cast<std::int32_t>(i)};
  }
  nodes_.resize(nodeCount(count));
  build(items, 0, 0);

  // Number points in leaf order, so that the data of a leaf is contiguous in memory.
  triangles_.reserve(count);
  leafPoints_.reserve(count);
  std::vector<std::int32_t> numberOf(all.size(), -1);
  std::vector<PointIndex> pointOf;
  pointOf.reserve(part.points.size());
  std::vector<std::int32_t> seenBy(part.points.size(), -1);
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    Node& node = nodes_[n];
    if (node.second >= 0) continue;
    node.firstPoint = countOf(leafPoints_);
    for (std::int32_t i = node.first; i < node.last; ++i) {
      Triangle t = part.triangles[items[i].triangle];
      for (PointIndex& p : t) {
        node.box.extend(all[p]);
        std::int32_t& number = numberOf[p];
        if (number < 0) {
          number = countOf(pointOf);
          pointOf.push_back(p);
        }
        if (seenBy[number] != static_cast<std::int32_t>(n)) {
          seenBy[number] = n;
          leafPoints_.push_back(number);
        }
        p = number;
      }
      triangles_.push_back(t);
    }
    node.lastPoint = countOf(leafPoints_);
  }
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    if (node.second < 0) continue;
    const Node& a = nodes_[n + 1];
    const Node& b = nodes_[node.second];
    node.firstPoint = a.firstPoint;
    node.lastPoint = b.lastPoint;
    node.box = a.box;
    node.box.extend(b.box.min);
    node.box.extend(b.box.max);
  }
  points_.resize(keyframes.size());
  parallelFor(keyframes.size(), [&](std::size_t k) {
    points_[k].reserve(pointOf.size());
    for (PointIndex p : pointOf) points_[k].push_back(keyframes[k][p]);
  });
}

void PartTree::build(std::span<Item> items, std::int32_t node, std::int32_t first) {
  Node& here = nodes_[node];
  here.first = first;
  here.last = first + countOf(items);
  if (items.size() <= kLeafTriangles) {
    // Libraries leave other orders behind; sums over a leaf are to be the same everywhere.
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.triangle < b.triangle; });
    return;
  }
  Vec3f low = items[0].center;
  Vec3f high = low;
  for (const Item& item : items) {
    low = low.cwiseMin(item.center);
    high = high.cwiseMax(item.center);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t middle = items.size() / 2;
  std::nth_element(items.begin(), items.begin() + middle, items.end(), [axis](const Item& a, const Item& b) {
    return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.triangle < b.triangle;
  });
  here.second = node + 1 + nodeCount(middle);
  const auto lower = [&] { build(items.first(middle), node + 1, first); };
  const auto upper = [&] { build(items.subspan(middle), here.second, first + middle); };
  if (items.size() > kSerialTriangles) {
    parallelBoth(lower, upper);
  } else {
    lower();
    upper();
  }
}

std::span<const std::int32_t> PartTree::pointsOf(std::int32_t node) const {
  const Node& n = nodes_[node];
  return std::span(leafPoints_).subspan(n.firstPoint, n.lastPoint - n.firstPoint);
}

bool PartTree::sketch(const Plane& plane, double tolerance, Sketch& out) const {
  thread_local PlaneSides sides;
  // Points already in a list of this sketch: bit 0 above, bit 1 below.
  thread_local std::vector<std::uint8_t> listed;
  const std::span<const Vec3> points = points_[keyframe_];
  listed.assign(points.size(), 0);
  for (Half* half : {&out.above, &out.below}) {
    half->nodes.clear();
    half->points.clear();
  }
  out.crossings.clear();
  out.leaves.clear();
  bool anyAbove = false, anyBelow = false;
  const Vec3 absolute = plane.normal.cwiseAbs();
  std::array<std::int32_t, 128> stack;
  int height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const std::int32_t index = stack[--height];
    const Node& node = nodes_[index];
    const double middle = plane.normal.dot(node.box.center()) - plane.offset;
    const double reach = 0.5 * absolute.dot(node.box.max - node.box.min) + tolerance;
    if (middle > reach) {
      out.above.nodes.push_back(index);
      anyAbove = true;
      continue;
    }
    if (middle < -reach) {
      out.below.nodes.push_back(index);
      anyBelow = true;
      continue;
    }
    if (node.second >= 0) {
      stack[height++] = node.second;
      stack[height++] = index + 1;
      continue;
    }
    for (std::int32_t p : pointsOf(index)) sides.classify(p, points, plane, tolerance);
    for (std::int32_t i = node.first; i < node.last; ++i) {
      const Triangle& t = triangles_[i];
      const std::array<int, 3> s = {sides.sideOf(t[0]), sides.sideOf(t[1]), sides.sideOf(t[2])};
      const int low = std::min({s[0], s[1], s[2]});
      const int high = std::max({s[0], s[1], s[2]});
      const int flatSide = low == 0 && high == 0 ? sides.sideOf(t, points, plane, tolerance) : 0;
      anyAbove |= high > 0;
      anyBelow |= low < 0;
      for (int c = 0; c < 3; ++c) {
        std::uint8_t& known = listed[t[c]];
        if (s[c] >= 0 && (high > 0 || flatSide > 0) && (known & 1U) == 0) {
          known |= 1U;
          out.above.points.push_back(t[c]);
        }
        if (s[c] <= 0 && (low < 0 || flatSide < 0) && (known & 2U) == 0) {
          known |= 2U;
          out.below.points.push_back(t[c]);
        }
        // In a closed part each edge occurs once in each direction: use the ascending one.
        const int d = (c + 1) % 3;
        if (s[c] * s[d] < 0 && t[c] < t[d]) out.crossings.push_back(sides.crossing(t[c], t[d]));
      }
    }
    out.leaves.push_back({index, out.above.points.size(), out.below.points.size(), out.crossings.size()});
  }
  return anyAbove && anyBelow;
}

}  // namespace lorica
