#include "acd/part_concavity.h"

#include "acd/hull_concavity.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

// Rounding turns the normals of faces thinner than this share of the hull's diagonal; their neighbours stand for them.
constexpr double kThin = 1e-5;
// A part is convex if its hull has at most this much more volume, as a share.
constexpr double kConvex = 1e-9;
constexpr int kSamples = 2000;  // on a hull, as many as CoACD takes
// More where it is near what matters.
constexpr int kNearSamples = 6000;
constexpr double kNear = 0.8;
constexpr double kMaxSurfaceSamples = 2e7;  // on a part: of very many slivers they are farther apart

}  // namespace

HullPlanes::HullPlanes(const ConvexHull& hull) {
  const double thin = kThin * boundsOf(hull.vertices).diagonal();
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = hull.vertices[t[0]];
    const Vec3 ab = hull.vertices[t[1]] - a, ac = hull.vertices[t[2]] - a;
    const double longest = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
    const Vec3 doubled = ab.cross(ac);
    if (!(doubled.norm() > thin * longest)) continue;
    normals_.push_back(doubled.normalized());
    offsets_.push_back(normals_.back().dot(a));
  }
}

double HullPlanes::depth(const Vec3& p, double enough) {
  double depth = kInfinity;
  std::size_t nearest = last_;
  // The face that was nearest last time first: it often tells that a point is not deep.
  for (std::size_t i = 0; i < normals_.size(); ++i) {
    const std::size_t at = i == 0 ? last_ : i == last_ ? 0 : i;
    const double below = offsets_[at] - normals_[at].dot(p);
    if (below >= depth) continue;
    depth = below;
    nearest = at;
    if (depth <= enough) break;
  }
  last_ = nearest;
  return depth <= enough || depth == kInfinity ? 0.0 : depth;
}

double emptyConcavity(double empty) {
  return kConcavityVolumeWeight * std::cbrt(3.0 * empty / (4.0 * std::numbers::pi));
}

double concavityUnit(std::span<const Vec3> points) {
  const Aabb box = boundsOf(points);
  return box.empty() ? 0.0 : 0.5 * (box.max - box.min).maxCoeff();
}

double partConcavity(const ConvexHull& hull, std::span<const Vec3> points, std::span<const Triangle> triangles,
                     double ignoreBelow, double enough) {
  if (hull.degenerate()) return 0.0;
  const double empty = std::abs(hull.volume - signedVolume(points, triangles));
  if (empty <= kConvex * hull.volume) return 0.0;
  double concavity = emptyConcavity(empty);
  if (concavity > enough) return concavity;
  HullPlanes planes(hull);
  const double spacing = 0.25 * std::max(ignoreBelow, 1e-3 * boundsOf(hull.vertices).diagonal());
  const auto rowsOf = [&](const Triangle& t, double apart) {
    const Vec3 ab = points[t[1]] - points[t[0]], ac = points[t[2]] - points[t[0]];
    const double longest = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
    return std::clamp(static_cast<int>(std::ceil(longest / apart)), 1, 64);
  };
  double all = 0.0;
  for (const Triangle& t : triangles) all += 0.5 * rowsOf(t, spacing) * rowsOf(t, spacing);
  const double apart = spacing * std::sqrt(std::max(1.0, all / kMaxSurfaceSamples));
  for (const Triangle& t : triangles) {
    const Vec3& a = points[t[0]];
    const Vec3 ab = points[t[1]] - a, ac = points[t[2]] - a;
    const int rows = rowsOf(t, apart);
    for (int i = 0; i <= rows; ++i) {
      for (int j = 0; i + j <= rows; ++j) {
        const Vec3 p = a + i * (1.0 / rows) * ab + j * (1.0 / rows) * ac;
        concavity = std::max(concavity, planes.depth(p, concavity));
      }
    }
    if (concavity > enough) return concavity;
  }
  const TriangleTree surface(points, triangles);
  for (const int samples : {kSamples, kNearSamples}) {
    for (const Vec3& p : spreadPoints(hull.vertices, hull.triangles, samples, samples)) {
      concavity = std::max(concavity, surface.distance(p, concavity));
      if (concavity > enough) return concavity;
    }
    if (concavity < kNear * ignoreBelow) break;
  }
  return concavity;
}

}  // namespace lorica
