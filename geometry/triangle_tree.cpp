#include "geometry/triangle_tree.h"

#include "geometry/counts.h"
#include "geometry/random_numbers.h"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace lorica {
namespace {

constexpr std::size_t kLeafSize = 4;
constexpr double kFar = 2.0;  // in radii of a group: beyond this distance it is treated as one dipole

/// Signed solid angle of a triangle over 4 pi (Van Oosterom and Strackee 1983).
double windingOf(const Vec3& p, const std::array<Vec3, 3>& triangle) {
  const Vec3 a = triangle[0] - p;
  const Vec3 b = triangle[1] - p;
  const Vec3 c = triangle[2] - p;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  if (numerator == 0.0) return 0.0;  // in the triangle's plane
  return std::atan2(numerator, denominator) / (2.0 * std::numbers::pi);
}

std::pair<double, double> nearestOnSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double lengthSq = ab.squaredNorm();
  const double t = lengthSq > 0.0 ? std::clamp((p - a).dot(ab) / lengthSq, 0.0, 1.0) : 0.0;
  return {(a + t * ab - p).squaredNorm(), t};
}

}  // namespace

std::pair<double, Vec3> nearestOnTriangle(const Vec3& p, const std::array<Vec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3 normal = (b - a).cross(c - a);
  const double normalSq = normal.squaredNorm();
  const double longestSq = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  // For a sliver only the edges are used: its normal is noise.
  if (normalSq > 1e-24 * longestSq * longestSq) {
    const Vec3 shares((c - b).cross(p - b).dot(normal), (a - c).cross(p - c).dot(normal),
                      (b - a).cross(p - a).dot(normal));
    if (shares.minCoeff() >= 0.0) {
      const double height = (p - a).dot(normal);
      return {height * height / normalSq, shares / shares.sum()};
    }
  }
  std::pair<double, Vec3> best{std::numeric_limits<double>::infinity(), Vec3::Zero()};
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const auto [distanceSq, t] = nearestOnSegment(p, triangle[i], triangle[j]);
    if (distanceSq >= best.first) continue;
    best.first = distanceSq;
    best.second.setZero();
    best.second[i] = 1.0 - t;
    best.second[j] = t;
  }
  return best;
}

TriangleTree::TriangleTree(std::vector<std::array<Vec3, 3>> corners, Use use)
    : corners_(std::move(corners)), original_(corners_.size()), use_(use) {
  LORICA_CHECK(!corners_.empty(), "a triangle tree needs at least one triangle");
  std::iota(original_.begin(), original_.end(), 0);
  nodes_.reserve(corners_.size());
  std::vector<Vec3> centers;
  centers.reserve(corners_.size());
  for (const auto& [a, b, c] : corners_) centers.emplace_back(a + b + c);
  build(centers, 0, corners_.size());
  // The tree was built over indices: reorder the corners to match.
  std::vector<std::array<Vec3, 3>> ordered;
  ordered.reserve(corners_.size());
  for (const std::int32_t i : original_) ordered.push_back(corners_[i]);
  corners_ = std::move(ordered);
}

TriangleTree::TriangleTree(std::span<const Vec3> vertices, std::span<const Triangle> triangles, Use use)
    : TriangleTree(
          [&] {
            std::vector<std::array<Vec3, 3>> corners;
            corners.reserve(triangles.size());
            for (const Triangle& t : triangles) corners.push_back({vertices[t[0]], vertices[t[1]], vertices[t[2]]});
            return corners;
          }(),
          use) {}

void TriangleTree::measure(Node& node, std::size_t first, std::size_t count) const {
  double area = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    const auto& [a, b, c] = corners_[original_[i]];
    const Vec3 normal = 0.5 * (b - a).cross(c - a);
    const double own = normal.norm();
    node.dipole += normal;
    node.center += own / 3.0 * (a + b + c);
    area += own;
  }
  node.center = area > 0.0 ? Vec3(node.center / area) : node.box.center();
  for (std::size_t i = first; i < first + count; ++i) {
    for (const Vec3& corner : corners_[original_[i]]) {
      node.radius = std::max(node.radius, (corner - node.center).squaredNorm());
    }
  }
  node.radius = std::sqrt(node.radius);
}

void TriangleTree::build(std::span<const Vec3> centers, std::size_t first, std::size_t count) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  if (count <= kLeafSize) {
    // Libraries leave other orders behind; sums are to be the same everywhere.
    std::sort(original_.begin() + first, original_.begin() + first + count);
    for (std::size_t i = first; i < first + count; ++i) {
      for (const Vec3& corner : corners_[original_[i]]) nodes_[self].box.extend(corner);
    }
    if (use_ == Use::kAll) measure(nodes_[self], first, count);
    nodes_[self].first = first;
    nodes_[self].count = count;
    return;
  }
  Aabb box;
  for (std::size_t i = first; i < first + count; ++i) box.extend(centers[original_[i]]);
  Eigen::Index axis = 0;
  (box.max - box.min).maxCoeff(&axis);
  const auto begin = original_.begin() + first;
  const std::size_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [&](std::int32_t a, std::int32_t b) {
    const double ca = centers[a][axis], cb = centers[b][axis];
    return ca != cb ? ca < cb : a < b;
  });
  build(centers, first, half);
  const std::size_t second = nodes_.size();
  nodes_[self].first = countOf(nodes_);
  build(centers, first + half, count - half);
  for (const std::size_t child : {self + 1, second}) {
    nodes_[self].box.extend(nodes_[child].box.min);
    nodes_[self].box.extend(nodes_[child].box.max);
  }
  if (use_ == Use::kAll) measure(nodes_[self], first, count);
}

double TriangleTree::windingNumber(const Vec3& p, std::size_t* looked) const {
  double sum = 0.0;
  std::array<std::int32_t, 64> stack;
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::int32_t index = stack[--depth];
    const Node& node = nodes_[index];
    const Vec3 offset = node.center - p;
    const double distanceSq = offset.squaredNorm();
    if (distanceSq > kFar * kFar * node.radius * node.radius) {
      sum += node.dipole.dot(offset) / (4.0 * std::numbers::pi * distanceSq * std::sqrt(distanceSq));
    } else if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        sum += windingOf(p, corners_[i]);
      }
      if (looked != nullptr) *looked += node.count;
    } else {
      stack[depth++] = node.first;
      stack[depth++] = index + 1;
    }
  }
  return sum;
}

std::vector<Vec3> spreadPoints(std::span<const Vec3> vertices, std::span<const Triangle> triangles, int count,
                               std::optional<std::uint64_t> seed) {
  std::vector<double> areaUpTo;
  areaUpTo.reserve(triangles.size());
  double area = 0.0;
  for (const Triangle& t : triangles) {
    area += 0.5 * areaNormal(vertices, t).norm();
    areaUpTo.push_back(area);
  }
  if (!(area > 0.0)) return {};
  // Within a triangle an additive recurrence (with powers of the plastic number) distributes consecutive points evenly.
  const auto unit = [&](std::uint64_t counter) { return seed ? randomUnit(*seed, counter) : 0.5; };
  const double offsetR = unit(0);
  const double offsetU = unit(1);
  const auto fraction = [](double x) { return x - std::floor(x); };
  std::vector<Vec3> points;
  points.reserve(count);
  std::size_t k = 0;
  for (int i = 0; i < count; ++i) {
    const double at = (i + unit(2 + i)) * area / count;
    while (k + 1 < areaUpTo.size() && areaUpTo[k] <= at) ++k;
    const Triangle& t = triangles[k];
    // The square root makes points uniform by area: it maps a uniform number to the distance from a corner.
    const double r = std::sqrt(fraction(offsetR + i * 0.7548776662466927));
    const double u = r * fraction(offsetU + i * 0.5698402909980532);
    points.emplace_back((1.0 - r) * vertices[t[0]] + (r - u) * vertices[t[1]] + u * vertices[t[2]]);
  }
  return points;
}

}  // namespace lorica
