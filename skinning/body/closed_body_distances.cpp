#include "geometry/triangle_tree.h"
#include "skinning/body/closed_body.h"
#include "skinning/linear_blend.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace lorica {
namespace {

constexpr int kSamples = 4096;
constexpr double kInside = 0.5;  // winding number

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
  result.meanOutside = meanOf(distancesOutside(bodyTree, spreadPoints(posed, character.shown, kSamples)));
  const std::vector<double> spread = distancesTo(shownTree, spreadPoints(posed, character.mesh.triangles, kSamples));
  result.meanToOriginal = meanOf(spread);
  result.farthestToOriginal = std::max(largestOf(spread), largestOf(distancesTo(shownTree, bodyVertices)));
  return result;
}

}  // namespace lorica
