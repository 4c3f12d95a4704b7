#include "acd/nearest_triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lorica {

namespace {

constexpr std::size_t kLeafSize = 4;

double distanceSqToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double lengthSq = ab.squaredNorm();
  const double t = lengthSq > 0.0 ? std::clamp((p - a).dot(ab) / lengthSq, 0.0, 1.0) : 0.0;
  return (a + t * ab - p).squaredNorm();
}

double distanceSqToBox(const Vec3& p, const Aabb& box) {
  return (box.min - p).cwiseMax(p - box.max).cwiseMax(0.0).squaredNorm();
}

}  // namespace

double distanceSqToTriangle(const Vec3& p, const std::array<Vec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3 normal = (b - a).cross(c - a);
  const double longestSq = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  // Of a sliver only the edges count: its normal is noise.
  if (normal.squaredNorm() > 1e-24 * longestSq * longestSq) {
    const bool above = (b - a).cross(p - a).dot(normal) >= 0.0 && (c - b).cross(p - b).dot(normal) >= 0.0 &&
                       (a - c).cross(p - c).dot(normal) >= 0.0;
    if (above) {
      const double height = (p - a).dot(normal);
      return height * height / normal.squaredNorm();
    }
  }
  return std::min({distanceSqToSegment(p, a, b), distanceSqToSegment(p, b, c), distanceSqToSegment(p, c, a)});
}

NearestTriangle::NearestTriangle(std::vector<std::array<Vec3, 3>> corners) {
  CHECK(!corners.empty(), "NearestTriangle needs a triangle: see score()");
  triangles_.reserve(corners.size());
  for (const std::array<Vec3, 3>& t : corners) triangles_.push_back({t, static_cast<std::int32_t>(triangles_.size())});
  nodes_.reserve(triangles_.size());
  build(0, triangles_.size());
}

void NearestTriangle::build(std::size_t first, std::size_t count) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  Aabb centers;
  for (std::size_t i = first; i < first + count; ++i) {
    const std::array<Vec3, 3>& t = triangles_[i].corners;
    for (const Vec3& corner : t) nodes_[self].box.extend(corner);
    centers.extend(t[0] + t[1] + t[2]);
  }
  if (count <= kLeafSize) {
    nodes_[self].first = static_cast<std::int32_t>(first);
    nodes_[self].count = static_cast<std::int32_t>(count);
    return;
  }
  Eigen::Index axis = 0;
  (centers.max - centers.min).maxCoeff(&axis);
  const auto center = [axis](const Entry& e) { return e.corners[0][axis] + e.corners[1][axis] + e.corners[2][axis]; };
  const auto begin = triangles_.begin() + static_cast<std::ptrdiff_t>(first);
  const std::size_t half = count / 2;
  std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half), begin + static_cast<std::ptrdiff_t>(count),
                   [&](const auto& a, const auto& b) { return center(a) < center(b); });
  build(first, half);
  nodes_[self].first = static_cast<std::int32_t>(nodes_.size());
  build(first + half, count - half);
}

NearestTriangle::Hit NearestTriangle::nearest(const Vec3& p) const {
  std::int32_t found = 0;
  double best = std::numeric_limits<double>::infinity();
  std::array<std::pair<std::int32_t, double>, 64> stack;  // the tree is balanced: never deeper than 32
  int depth = 0;
  stack[depth++] = {0, distanceSqToBox(p, nodes_[0].box)};
  while (depth > 0) {
    const auto [index, boxDistanceSq] = stack[--depth];
    if (boxDistanceSq >= best) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
        const double distanceSq = distanceSqToTriangle(p, triangles_[i].corners);
        if (distanceSq >= best) continue;
        best = distanceSq;
        found = i;
      }
      continue;
    }
    std::pair<std::int32_t, double> near{index + 1, distanceSqToBox(p, nodes_[index + 1].box)};
    std::pair<std::int32_t, double> far{node.first, distanceSqToBox(p, nodes_[node.first].box)};
    if (far.second < near.second) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return {std::sqrt(best), found, triangles_[static_cast<std::size_t>(found)].given};
}

}  // namespace lorica
