#include "acd/part_concavity.h"

#include "acd/cut.h"
#include "acd/hull_distance.h"
#include "acd/volume_coverage.h"
#include "geometry/counts.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

// Rounding turns the normals of faces thinner than this share of the hull's diagonal; their neighbours stand for them.
constexpr double kThin = 1e-5;
// A part is convex if its hull has at most this much more volume, as a share.
constexpr double kNoSpace = 1e-9;
// Distances from planes are inexact by less than this share of the hull's diagonal.
constexpr double kPlaneRounding = 1e-13;
constexpr double kTold = 0.05;  // distances of a hull up to this share of what need not be told apart are not
constexpr double kMaxSurfaceSamples = 2e7;  // on a part: of very many slivers they are farther apart

constexpr double kOnFace = 1e-7;  // of the hull's diagonal: nearer to a plane is in the hull
constexpr int kLines = 4096;      // for the volume of a part
constexpr double kInside = 0.5;   // winding number

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

bool HullPlanes::holdsNear(const std::array<Vec3, 3>& triangle, double enough) {
  const auto near = [&](std::size_t plane) {
    return std::ranges::all_of(triangle,
                               [&](const Vec3& p) { return offsets_[plane] - normals_[plane].dot(p) <= enough; });
  };
  if (!normals_.empty() && near(last_)) return true;
  for (std::size_t i = 0; i < normals_.size(); ++i) {
    if (!near(i)) continue;
    last_ = i;
    return true;
  }
  return normals_.empty();
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
  if (empty <= kNoSpace * hull.volume) return 0.0;
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
  const double rounding = kPlaneRounding * boundsOf(hull.vertices).diagonal();
  for (const Triangle& t : triangles) {
    const Vec3& a = points[t[0]];
    if (planes.holdsNear({a, points[t[1]], points[t[2]]}, concavity - rounding)) continue;
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
  return std::max(concavity, hullDistance(hull, points, triangles, std::max(concavity, kTold * ignoreBelow), enough));
}

TriMesh clippedToHull(const TriMesh& solid, const ConvexHull& hull) {
  const Aabb box = boundsOf(hull.vertices);
  const double margin = kOnFace * box.diagonal();
  const HullPlanes planes(hull);
  TriMesh part;
  std::vector<Vec3> polygon, kept;
  for (const Triangle& t : solid.triangles) {
    polygon.assign({solid.vertices[t[0]], solid.vertices[t[1]], solid.vertices[t[2]]});
    if (!overlap(boundsOf(polygon), box)) continue;
    for (std::size_t i = 0; i < planes.count() && polygon.size() >= 3; ++i) {
      keepBelow(polygon, {planes.normal(i), planes.offset(i) + margin}, kept);
    }
    if (polygon.size() < 3) continue;
    const VertexIndex first = countOf(part.vertices);
    part.vertices.insert(part.vertices.end(), polygon.begin(), polygon.end());
    for (VertexIndex i = 1; i + 1 < countOf(polygon); ++i) part.triangles.push_back({first, first + i, first + i + 1});
  }
  return part;
}

double hullConcavity(const TriMesh& solid, const TriangleTree& tree, const ConvexHull& hull, int samples,
                     std::uint64_t seed) {
  if (hull.degenerate()) return 0.0;
  const double empty = hull.volume - commonVolume(solid, hull, kLines, seed);
  double concavity = emptyConcavity(std::max(empty, 0.0));
  const TriMesh part = clippedToHull(solid, hull);
  if (part.triangles.empty()) return concavity;
  HullPlanes planes(hull);
  for (const Vec3& p : part.vertices) concavity = std::max(concavity, planes.depth(p, concavity));
  for (const Vec3& p : spreadPoints(part.vertices, part.triangles, samples, seed)) {
    concavity = std::max(concavity, planes.depth(p, concavity));
  }
  const TriangleTree surface(part.vertices, part.triangles);
  for (const Vec3& p : spreadPoints(hull.vertices, hull.triangles, samples, seed + 1)) {
    const double distance = surface.distance(p, concavity);
    if (distance > concavity && tree.windingNumber(p) < kInside) concavity = distance;
  }
  return concavity;
}

}  // namespace lorica
