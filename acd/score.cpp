#include "acd/score.h"

#include "acd/part_concavity.h"
#include "acd/volume_coverage.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/random_numbers.h"
#include "geometry/shell_union.h"
#include "geometry/threads.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace lorica {

namespace {

constexpr double kOnSurface = 1e-6;  // of the diagonal: nearer to a hull's surface is not in the hull
constexpr double kInsideMesh = 0.5;  // winding number

/// Appends the surface for distances: the hull's faces; for a flat part its triangles, or its points if it has none.
void appendSurface(const TriMesh& part, const ConvexHull& hull, std::vector<std::array<Vec3, 3>>& surface) {
  for (const Triangle& t : hull.triangles) {
    surface.push_back({hull.vertices[t[0]], hull.vertices[t[1]], hull.vertices[t[2]]});
  }
  if (!hull.degenerate()) return;
  for (const Triangle& t : part.triangles) {
    surface.push_back({part.vertices[t[0]], part.vertices[t[1]], part.vertices[t[2]]});
  }
  if (!part.triangles.empty()) return;
  for (const Vec3& p : part.vertices) surface.push_back({p, p, p});
}

Distances summary(std::vector<double> distances) {
  if (distances.empty()) return {};
  std::sort(distances.begin(), distances.end());
  const double sum = std::accumulate(distances.begin(), distances.end(), 0.0);
  return {sum / distances.size(), distances[(distances.size() - 1) * 19 / 20], distances.back()};
}

/// From the hulls to the surface, where they are in neither the solid nor another hull. Each hull has as many points as
/// its share of all areas.
Distances distancesToSurface(const TriangleTree& solid, const TriangleTree& surface, std::span<const ConvexHull> hulls,
                             const ScoreSettings& settings) {
  std::vector<HullPlanes> planes;
  std::vector<Aabb> boxes;
  TriMesh all;
  for (const ConvexHull& hull : hulls) {
    const VertexIndex first = countOf(all.vertices);
    all.vertices.insert(all.vertices.end(), hull.vertices.begin(), hull.vertices.end());
    for (const Triangle& t : hull.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    planes.emplace_back(hull);
    boxes.push_back(boundsOf(hull.vertices));
  }
  const double margin = kOnSurface * boundsOf(all.vertices).diagonal();
  const auto inside = [&](std::size_t h, const Vec3& p) {
    if ((p.array() < boxes[h].min.array()).any() || (p.array() > boxes[h].max.array()).any()) return false;
    for (std::size_t i = 0; i < planes[h].count(); ++i) {
      if (planes[h].normal(i).dot(p) > planes[h].offset(i) - margin) return false;
    }
    return planes[h].count() > 0;
  };
  const std::vector<Vec3> points =
      spreadPoints(all.vertices, all.triangles, settings.surfaceSamples, randomBits(settings.seed, 2u << 20));
  std::vector<double> found(points.size(), -1.0);
  parallelFor(points.size(), [&](std::size_t i) {
    const Vec3& p = points[i];
    if (solid.windingNumber(p) > kInsideMesh) return;
    for (std::size_t h = 0; h < planes.size(); ++h) {
      if (inside(h, p)) return;
    }
    found[i] = surface.distance(p);
  });
  std::erase_if(found, [](double distance) { return distance < 0.0; });
  return summary(std::move(found));
}

Result<void> checkParts(std::span<const TriMesh> parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const TriMesh& part = parts[i];
    for (std::size_t v = 0; v < part.vertices.size(); ++v) {
      if (part.vertices[v].allFinite()) continue;
      return badMesh("part {}: vertex {} is not finite", i, v);
    }
    for (std::size_t k = 0; k < part.triangles.size(); ++k) {
      for (const VertexIndex v : part.triangles[k]) {
        if (v >= 0 && v < countOf(part.vertices)) continue;
        return badMesh("part {}: triangle {}: vertex index {} is out of range ({} vertices)", i, k, v,
                       part.vertices.size());
      }
    }
  }
  return {};
}

}  // namespace

Result<Score> score(const TriMesh& given, std::span<const TriMesh> parts, const ScoreSettings& settings,
                    const TriMesh* surface) {
  if (settings.volumeSamples < 16) {
    return invalidArgument("volumeSamples is {}, expected 16 or more", settings.volumeSamples);
  }
  if (settings.surfaceSamples < 1 || settings.concavitySamples < 1) {
    return invalidArgument("surfaceSamples is {}, concavitySamples {}: expected 1 or more of each",
                           settings.surfaceSamples, settings.concavitySamples);
  }
  LORICA_TRY_DO(checkClosedTwoManifold(given));
  LORICA_TRY_DO(checkParts(parts));
  Result<std::optional<ShellUnion>> united = uniteShells(given);
  if (!united && surface == nullptr) return united.error();  // walls may pass through each other
  const TriMesh& mesh = united && *united ? (*united)->mesh : given;

  std::vector<ConvexHull> hulls;
  std::vector<std::array<Vec3, 3>> hullSurface;
  double hullVolume = 0.0;
  for (const TriMesh& part : parts) {
    hulls.push_back(convexHull(part.vertices));
    hullVolume += hulls.back().volume;
    appendSurface(part, hulls.back(), hullSurface);
  }
  if (!(hullVolume > 0.0)) return invalidArgument("none of the {} parts has a volume", parts.size());

  Score result;
  const double meshVolume = signedVolume(mesh.vertices, mesh.triangles);
  result.score17 = meshVolume / hullVolume;

  // Eq. 16 with the covered fraction f: f V / ((1 - f) V + H), and its derivative for the standard error.
  const Coverage coverage = estimateCoverage(mesh, hulls, settings.volumeSamples, settings.seed);
  const double below = (1.0 - coverage.fraction) * meshVolume + hullVolume;
  result.score16 = coverage.fraction * meshVolume / below;
  result.score16StandardError = coverage.standardError * meshVolume * (meshVolume + hullVolume) / (below * below);
  result.uncoveredFraction = 1.0 - coverage.fraction;

  const TriangleTree nearest(std::move(hullSurface));
  const TriMesh& measured = surface != nullptr ? *surface : mesh;
  std::vector<double> distances;
  for (const Vec3& p : spreadPoints(measured.vertices, measured.triangles, settings.surfaceSamples,
                                    randomBits(settings.seed, 1u << 20))) {
    distances.push_back(nearest.distance(p));
  }
  result.toHulls = summary(std::move(distances));
  result.distance = result.toHulls.mean;
  const Aabb box = surfaceBounds(measured);
  result.distancePercentDiagonal = 100.0 * result.distance / box.diagonal();

  const TriangleTree solid(mesh.vertices, mesh.triangles);
  const TriangleTree own(measured.vertices, measured.triangles);
  result.toSurface = distancesToSurface(solid, own, hulls, settings);
  std::vector<double> concavities(hulls.size());
  parallelFor(hulls.size(), [&](std::size_t i) {
    concavities[i] =
        hullConcavity(mesh, solid, hulls[i], settings.concavitySamples, randomBits(settings.seed, (3u << 20) + i));
  });
  const double unit = 0.5 * (box.max - box.min).maxCoeff();
  result.concavity = *std::max_element(concavities.begin(), concavities.end()) / unit;
  result.meanConcavity = std::accumulate(concavities.begin(), concavities.end(), 0.0) / (unit * concavities.size());
  return result;
}

}  // namespace lorica
