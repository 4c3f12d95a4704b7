#include "acd/held_vertices.h"

#include "acd/transfer.h"
#include "geometry/threads.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <optional>

namespace lorica {
namespace {

constexpr double kHeld = 1e-9;  // of the diagonal: so near a hull a vertex counts as inside

/// A part's hull, for asking how far points protrude. Planes of a hull's slivers are meaningless, so distances are
/// those from its triangles.
struct Obstacle {
  Aabb box;
  std::vector<Vec3> vertices;
  std::optional<TriangleTree> tree;  ///< none if the hull is flat

  explicit Obstacle(const ConvexHull& hull) : box(boundsOf(hull.vertices)), vertices(hull.vertices) {
    if (!hull.degenerate()) tree.emplace(hull.vertices, hull.triangles);
  }

  /// Distance of a point outside the hull, 0 inside; for a flat hull, distance from its nearest vertex.
  [[nodiscard]] double distance(const Vec3& p) const {
    constexpr double kInside = 0.5;  // winding number
    if (tree) return tree->windingNumber(p) > kInside ? 0.0 : tree->distance(p);
    double min = kInfinity;
    for (const Vec3& vertex : vertices) min = std::min(min, (vertex - p).norm());
    return min;
  }
};

}  // namespace

std::vector<std::vector<PointIndex>> assignHeldVertices(const Decomposition& decomposition,
                                                        std::span<const Vec3> vertices,
                                                        std::span<const VertexIndex> held) {
  std::vector<std::vector<PointIndex>> verticesOfPart(decomposition.parts.size());
  if (held.empty() || verticesOfPart.empty()) return verticesOfPart;
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, vertices, points);
  std::vector<Obstacle> obstacles;
  for (const ConvexHull& hull : partHulls(decomposition, points)) obstacles.emplace_back(hull);
  Aabb all;
  for (const Obstacle& obstacle : obstacles) {
    all.extend(obstacle.box.min);
    all.extend(obstacle.box.max);
  }
  const double inside = kHeld * all.diagonal();

  constexpr std::size_t kNone = -1;
  std::vector<std::size_t> partOf(held.size(), kNone);
  parallelFor(held.size(), [&](std::size_t k) {
    const Vec3& p = vertices[held[k]];
    double least = kInfinity;
    for (std::size_t i = 0; i < obstacles.size() && least > inside; ++i) {
      if (distanceSqToBox(p, obstacles[i].box) >= least * least) continue;
      const double distance = obstacles[i].distance(p);
      if (distance >= least) continue;
      least = distance;
      partOf[k] = i;
    }
    if (least <= inside) partOf[k] = kNone;
  });
  for (std::size_t k = 0; k < held.size(); ++k) {
    if (partOf[k] != kNone) verticesOfPart[partOf[k]].push_back(held[k]);
  }
  for (std::vector<PointIndex>& own : verticesOfPart) std::sort(own.begin(), own.end());
  return verticesOfPart;
}

Decomposition withHeldVertices(Decomposition decomposition, std::span<const std::vector<PointIndex>> verticesOfPart) {
  LORICA_CHECK(verticesOfPart.size() == decomposition.parts.size(), "there must be one list of vertices for each part");
  for (std::size_t i = 0; i < verticesOfPart.size(); ++i) {
    std::vector<PointIndex>& points = decomposition.parts[i].points;
    points.insert(points.end(), verticesOfPart[i].begin(), verticesOfPart[i].end());
    std::sort(points.begin(), points.end());
  }
  return decomposition;
}

HullCover coverWithHeldVertices(const Decomposition& decomposition) {
  HullCover cover;
  for (const Part& part : decomposition.parts) {
    std::vector<CoverPoint>& points = cover.points.emplace_back();
    for (const PointIndex p : spanningPoints(decomposition, part)) points.push_back({p, Vec3::Zero()});
  }
  return cover;
}

}  // namespace lorica
