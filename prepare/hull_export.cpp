#include "prepare/hull_export.h"

#include "acd/hull_budget.h"
#include "acd/transfer.h"
#include "geometry/errors.h"
#include "geometry/parallel_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lorica {

std::vector<ConvexHull> hullsIn(const Decomposition& decomposition, std::span<const Vec3> vertices) {
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, vertices, points);
  return partHulls(decomposition, points);
}

HullExport exportHulls(std::span<const ConvexHull> hulls, int maxVertices, int threads,
                       const std::function<bool(int done, int hulls)>& progress) {
  std::vector<BudgetedHull> exported(hulls.size());
  (void)inParallel(hulls.size(), threads, progress, [&](std::size_t i) {
    const ConvexHull& hull = hulls[i];
    exported[i] = maxVertices > 0 ? simplifyHull(hull, maxVertices)
                                  : BudgetedHull{{hull.vertices, hull.triangles}, hull.volume, 1.0};
  });

  HullExport result;
  result.objects.reserve(hulls.size());
  result.growth.reserve(hulls.size());
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < hulls.size(); ++i) {
    before += hulls[i].volume;
    after += exported[i].volume;
    result.growth.push_back(exported[i].growth);
    result.maxVertices = std::max(result.maxVertices, exported[i].mesh.vertices.size());
    result.maxVerticesBefore = std::max(result.maxVerticesBefore, hulls[i].vertices.size());
    result.objects.push_back({fmt::format("part_{}", i), std::move(exported[i].mesh)});
  }
  if (before > 0.0) result.totalGrowth = after / before;
  return result;
}

Result<void> checkHullsHold(const HullExport& hulls, std::span<const Vec3> vertices,
                            std::span<const VertexIndex> which) {
  constexpr double kOutside = 1e-6;  // of the diagonal
  struct Solid {
    std::vector<std::pair<Vec3, double>> planes;  // normal and offset; none if it is flat
    std::vector<Vec3> vertices;
    Aabb box;
  };
  std::vector<Solid> solids;
  Aabb all;
  for (const NamedMesh& object : hulls.objects) {
    Solid& solid = solids.emplace_back();
    solid.vertices = object.mesh.vertices;
    for (const Vec3& p : solid.vertices) {
      solid.box.extend(p);
      all.extend(p);
    }
    for (const Triangle& t : object.mesh.triangles) {
      const Vec3& a = solid.vertices[t[0]];
      const Vec3 ab = solid.vertices[t[1]] - a;
      const Vec3 ac = solid.vertices[t[2]] - a;
      // The plane of a sliver is meaningless, see largestViolation().
      const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
      if (ab.cross(ac).norm() <= 1e-7 * solid.box.diagonal() * longest) continue;
      const Vec3 normal = ab.cross(ac).normalized();
      solid.planes.emplace_back(normal, normal.dot(a));
    }
  }
  const double tolerance = kOutside * all.diagonal();
  std::vector<double> outside(which.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t k) {
    const Vec3& p = vertices[which[k]];
    double least = kInfinity;
    for (const auto& [planes, corners, box] : solids) {
      double distance = (box.min - p).cwiseMax(p - box.max).cwiseMax(0.0).norm();
      for (const auto& [normal, offset] : planes) {
        if (distance >= least) break;
        distance = std::max(distance, normal.dot(p) - offset);
      }
      if (planes.empty()) {
        distance = kInfinity;
        for (const Vec3& corner : corners) distance = std::min(distance, (corner - p).norm());
      }
      least = std::min(least, distance);
      if (least <= tolerance) break;
    }
    outside[k] = least;
  });
  const auto worst = std::max_element(outside.begin(), outside.end());
  if (worst == outside.end() || *worst <= tolerance) return {};
  const VertexIndex v = which[worst - outside.begin()];
  const Vec3& p = vertices[v];
  return badMesh(
      "vertex {} at ({:g}, {:g}, {:g}) is {:g} outside all hulls, expected at most {:g}; nothing was written", v, p.x(),
      p.y(), p.z(), *worst, tolerance);
}

}  // namespace lorica
