#include "acd/hull_concavity.h"

#include "acd/part_concavity.h"
#include "acd/volume_coverage.h"
#include "geometry/counts.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr double kOnFace = 1e-7;  // of the hull's diagonal: nearer to a plane is in the hull
constexpr int kLines = 4096;      // for the volume of a part
constexpr double kInside = 0.5;   // winding number

/// What is left of a polygon below a plane.
void clip(std::vector<Vec3>& polygon, const Vec3& normal, double offset, std::vector<Vec3>& kept) {
  kept.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double aboveA = normal.dot(a) - offset, aboveB = normal.dot(b) - offset;
    if (aboveA <= 0.0) kept.push_back(a);
    if ((aboveA < 0.0 && aboveB > 0.0) || (aboveA > 0.0 && aboveB < 0.0)) {
      kept.push_back(a + aboveA / (aboveA - aboveB) * (b - a));
    }
  }
  std::swap(polygon, kept);
}

}  // namespace

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
      clip(polygon, planes.normal(i), planes.offset(i) + margin, kept);
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
