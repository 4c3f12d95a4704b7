#include "collision/live/hull_distance.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace lorica {
namespace {

constexpr int kMaxSteps = 64;
constexpr double kProgress = 1e-12;  ///< share of the squared distance below which a step gains nothing

/// Corners of the Minkowski sum of hull and segment, seen from the segment's middle, and where on the hull they are.
struct Simplex {
  struct Corner {
    Vec3 at = Vec3::Zero(), onHull = Vec3::Zero();
    double weight = 1.0;
  };
  std::array<Corner, 4> corner;
  std::size_t count = 0;

  [[nodiscard]] Vec3 nearest() const { return weighted(&Corner::at); }
  [[nodiscard]] Vec3 onHull() const { return weighted(&Corner::onHull); }
  [[nodiscard]] Vec3 weighted(Vec3 Corner::*of) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) sum += corner[i].weight * corner[i].*of;
    return sum;
  }
  void keep(std::initializer_list<std::pair<std::size_t, double>> kept) {
    const std::array<Corner, 4> all = corner;
    count = 0;
    for (const auto& [which, weight] : kept) {
      corner[count] = all[which];
      corner[count++].weight = weight;
    }
  }
};

/// The part of two corners that is nearest to the origin.
Simplex onEdge(Simplex s, std::size_t i, std::size_t j) {
  const Vec3 along = s.corner[j].at - s.corner[i].at;
  const double square = along.squaredNorm();
  const double t = square > 0.0 ? -s.corner[i].at.dot(along) / square : 0.0;
  if (t <= 0.0) {
    s.keep({{i, 1.0}});
  } else if (t >= 1.0) {
    s.keep({{j, 1.0}});
  } else {
    s.keep({{i, 1.0 - t}, {j, t}});
  }
  return s;
}

/// The nearest of several.
Simplex nearestOf(std::initializer_list<Simplex> all) {
  return *std::min_element(all.begin(), all.end(), [](const Simplex& a, const Simplex& b) {
    return a.nearest().squaredNorm() < b.nearest().squaredNorm();
  });
}

/// The part of three corners that is nearest to the origin.
Simplex onFace(Simplex s, std::size_t i, std::size_t j, std::size_t k) {
  const Vec3 &a = s.corner[i].at, &b = s.corner[j].at, &c = s.corner[k].at;
  const Vec3 normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  if (square > 0.0) {
    const double u = b.cross(c).dot(normal) / square, v = c.cross(a).dot(normal) / square;
    const double w = a.cross(b).dot(normal) / square;
    if (u > 0.0 && v > 0.0 && w > 0.0) {
      s.keep({{i, u}, {j, v}, {k, w}});
      return s;
    }
  }
  return nearestOf({onEdge(s, i, j), onEdge(s, j, k), onEdge(s, k, i)});
}

/// Whether the origin is not on the inner side of a face, as the corner opposite is.
bool isOutside(const Simplex& s, std::size_t i, std::size_t j, std::size_t k, std::size_t opposite) {
  const Vec3& a = s.corner[i].at;
  const Vec3 normal = (s.corner[j].at - a).cross(s.corner[k].at - a);
  const double inner = normal.dot(s.corner[opposite].at - a), here = -normal.dot(a);
  return inner == 0.0 || inner * here < 0.0;
}

/// Leaves the corners that the nearest point to the origin needs; all four if the origin is inside.
void reduce(Simplex& s) {
  if (s.count == 2) s = onEdge(s, 0, 1);
  if (s.count == 3) s = onFace(s, 0, 1, 2);
  if (s.count < 4) return;
  constexpr std::array<std::array<std::size_t, 4>, 4> kFaces = {
      {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}}};
  const Simplex all = s;
  double least = kInfinity;
  for (const auto& [i, j, k, opposite] : kFaces) {
    if (!isOutside(all, i, j, k, opposite)) continue;
    const Simplex face = onFace(all, i, j, k);
    const double square = face.nearest().squaredNorm();
    if (square >= least) continue;
    least = square;
    s = face;
  }
}

/// The vertex that is farthest along a direction.
const Vec3& farthestOf(std::span<const Vec3> vertices, const Vec3& direction) {
  std::size_t best = 0;
  double most = -kInfinity;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double along = vertices[i].dot(direction);
    if (along <= most) continue;
    most = along;
    best = i;
  }
  return vertices[best];
}

/// @param first     a corner's direction
/// @param farthest  the corner of the Minkowski sum that is farthest along a direction
template <typename Farthest>
HullGap search(const Vec3& first, const Farthest& farthest) {
  Simplex simplex;
  simplex.corner[0] = farthest(first);
  simplex.count = 1;
  Vec3 nearest = simplex.nearest();
  for (int step = 0; step < kMaxSteps; ++step) {
    const double square = nearest.squaredNorm();
    const Simplex::Corner next = farthest(-nearest);
    // No corner is nearer than the plane through the nearest point.
    if (!(square - nearest.dot(next.at) > kProgress * square)) break;
    simplex.corner[simplex.count++] = next;
    Simplex reduced = simplex;
    reduce(reduced);
    if (reduced.count == 4) return {};
    const Vec3 found = reduced.nearest();
    if (!(found.squaredNorm() < square)) {
      --simplex.count;
      break;
    }
    simplex = reduced;
    nearest = found;
  }
  HullGap gap{nearest.norm(), simplex.onHull(), Vec3::Zero()};
  if (gap.distance > 0.0) gap.normal = -nearest / gap.distance;
  return gap;
}

}  // namespace

HullGap gapOf(std::span<const Vec3> vertices, const Vec3& middle, const Vec3& half) {
  return search(middle - vertices[0], [&](const Vec3& direction) {
    const Vec3& vertex = farthestOf(vertices, direction);
    const Vec3 end = half.dot(direction) < 0.0 ? Vec3(-half) : half;
    return Simplex::Corner{vertex - middle + end, vertex, 1.0};
  });
}

HullGap gapOf(std::span<const Vec3> vertices, std::span<const Vec3> others) {
  return search(others[0] - vertices[0], [&](const Vec3& direction) {
    const Vec3& vertex = farthestOf(vertices, direction);
    return Simplex::Corner{vertex - farthestOf(others, -direction), vertex, 1.0};
  });
}

}  // namespace lorica
