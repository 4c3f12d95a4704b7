#include "acd/score.h"

#include "acd/volume_coverage.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/random_numbers.h"
#include "geometry/shell_union.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace lorica {

namespace {

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

/// Mean distance from the mesh's surface to `surface`. Stratified sampling: one point in each of `samples` equal areas.
double meanDistance(const TriMesh& mesh, const TriangleTree& surface, int samples, std::uint64_t seed) {
  std::vector<double> areaUpTo;
  areaUpTo.reserve(mesh.triangles.size());
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    area += 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
    areaUpTo.push_back(area);
  }
  // Within a triangle an additive recurrence (with powers of the plastic number) distributes consecutive points evenly.
  const double offsetR = randomUnit(seed, 0);
  const double offsetU = randomUnit(seed, 1);
  const auto fraction = [](double x) { return x - std::floor(x); };
  double sum = 0.0;
  std::size_t k = 0;
  for (int i = 0; i < samples; ++i) {
    const double at = (i + randomUnit(seed, 2 + i)) * area / samples;
    while (k + 1 < areaUpTo.size() && areaUpTo[k] <= at) ++k;
    const Triangle& t = mesh.triangles[k];
    // The square root makes points uniform by area: it maps a uniform number to the distance from a corner.
    const double r = std::sqrt(fraction(offsetR + i * 0.7548776662466927));
    const double u = r * fraction(offsetU + i * 0.5698402909980532);
    sum += surface.distance((1.0 - r) * mesh.vertices[t[0]] + (r - u) * mesh.vertices[t[1]] + u * mesh.vertices[t[2]]);
  }
  return sum / samples;
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

Result<Score> score(const TriMesh& given, std::span<const TriMesh> parts, const ScoreSettings& settings) {
  if (settings.volumeSamples < 16) {
    return invalidArgument("volumeSamples is {}, expected 16 or more", settings.volumeSamples);
  }
  if (settings.surfaceSamples < 1) {
    return invalidArgument("surfaceSamples is {}, expected 1 or more", settings.surfaceSamples);
  }
  LORICA_TRY_DO(checkClosedTwoManifold(given));
  LORICA_TRY_DO(checkParts(parts));
  LORICA_TRY(const std::optional<ShellUnion> united, uniteShells(given));
  const TriMesh& mesh = united ? united->mesh : given;

  std::vector<ConvexHull> hulls;
  std::vector<std::array<Vec3, 3>> surface;
  double hullVolume = 0.0;
  for (const TriMesh& part : parts) {
    hulls.push_back(convexHull(part.vertices));
    hullVolume += hulls.back().volume;
    appendSurface(part, hulls.back(), surface);
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

  const TriangleTree nearest(std::move(surface));
  result.distance = meanDistance(mesh, nearest, settings.surfaceSamples, randomBits(settings.seed, 1u << 20));
  result.distancePercentDiagonal = 100.0 * result.distance / surfaceBounds(mesh).diagonal();
  return result;
}

}  // namespace lorica
