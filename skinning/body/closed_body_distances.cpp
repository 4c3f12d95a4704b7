#include "geometry/triangle_tree.h"
#include "skinning/body/closed_body.h"
#include "skinning/linear_blend.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr std::size_t kSamples = 4096;
constexpr double kInside = 0.5;  // winding number

/// Points spread evenly over a surface: its area is laid out as one strip, with a point in the middle of equal pieces.
std::vector<Vec3> spreadPoints(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  const double area = surfaceArea(vertices, triangles);
  std::vector<Vec3> points;
  if (!(area > 0.0)) return points;
  points.reserve(kSamples);
  const auto fraction = [](double x) { return x - std::floor(x); };
  double upTo = 0.0;
  for (const Triangle& t : triangles) {
    const Vec3& a = vertices[t[0]];
    const Vec3& b = vertices[t[1]];
    const Vec3& c = vertices[t[2]];
    upTo += 0.5 * (b - a).cross(c - a).norm();
    while (points.size() < kSamples && (points.size() + 0.5) * area / kSamples <= upTo) {
      // Within a triangle an additive recurrence (with powers of the plastic number) spreads consecutive points; the
      // square root makes them uniform in area.
      const double i = points.size();
      const double r = std::sqrt(fraction(0.5 + i * 0.7548776662466927));
      const double u = r * fraction(0.5 + i * 0.5698402909980532);
      points.emplace_back((1.0 - r) * a + (r - u) * b + u * c);
    }
  }
  return points;
}

std::vector<double> distancesOutside(const TriangleTree& tree, std::span<const Vec3> points) {
  std::vector<double> distances(points.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (tree.windingNumber(points[i]) < kInside) distances[i] = tree.nearest(points[i]).distance;
  });
  return distances;
}

std::vector<double> distancesTo(const TriangleTree& tree, std::span<const Vec3> points) {
  std::vector<double> distances(points.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, points.size(),
                    [&](std::size_t i) { distances[i] = tree.nearest(points[i]).distance; });
  return distances;
}

double meanOf(std::span<const double> values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? 0.0 : sum / values.size();
}

double largestOf(std::span<const double> values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

}  // namespace

BodyDistances distancesInPose(const ClosedBody& body, std::span<const Affine3> worldFromModel) {
  BodyDistances result;
  if (!body.made) return result;
  const Character& character = body.character;
  std::vector<Vec3> posed(character.mesh.vertices.size());
  skinLinearBlend(character, worldFromModel, posed);
  const std::size_t bodyCount = body.bodyVertices;
  const std::span<const Vec3> bodyVertices = std::span(posed).first(bodyCount);
  const std::size_t shownCount = posed.size() - bodyCount - body.reachedVertices;
  const std::span<const Vec3> shownVertices = std::span(posed).subspan(bodyCount, shownCount);

  const TriangleTree bodyTree(posed, character.mesh.triangles);
  const TriangleTree shownTree(posed, character.shown);
  result.farthestOutside = largestOf(distancesOutside(bodyTree, shownVertices));
  result.meanOutside = meanOf(distancesOutside(bodyTree, spreadPoints(posed, character.shown)));
  const std::vector<double> spread = distancesTo(shownTree, spreadPoints(posed, character.mesh.triangles));
  result.meanToOriginal = meanOf(spread);
  result.farthestToOriginal = std::max(largestOf(spread), largestOf(distancesTo(shownTree, bodyVertices)));
  return result;
}

}  // namespace lorica
