#include "collision/hulls/quality.h"

#include "acd/hull_distance.h"
#include "acd/part_concavity.h"
#include "acd/transfer.h"
#include "collision/live/choose_cover.h"
#include "collision/live/lifted_point.h"
#include "geometry/counts.h"
#include "geometry/text.h"
#include "geometry/threads.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace lorica {

Quality measureQuality(const TriMesh& mesh, PoseView keyframes, const UsedHulls& hulls) {
  Quality quality;
  const double share = 1.0 / keyframes.keyframeCount();
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    PoseError pose;
    for (const ConvexHull& hull : hulls[k]) pose.hullVolume += hull.volume;
    // A surface that overlaps itself counts some volume twice; but it is no larger than the hulls, which hold it.
    pose.meshVolume = std::min(signedVolume(keyframes.keyframe(k), mesh.triangles), pose.hullVolume);
    quality.errorPerKeyframe.push_back(pose.relative());
    quality.meshVolume += share * pose.meshVolume;
    quality.hullVolume += share * pose.hullVolume;
    quality.score += share * pose.meshVolume / pose.hullVolume;
    quality.error += share * pose.relative();
  }
  return quality;
}

std::string doubtAboutHulls(double error) {
  constexpr double kDoubtful = 0.5;
  if (!(error > kDoubtful)) return "";
  return fmt::format(
      "the hulls have {} more volume than the mesh, expected at most {}: set a limit on the error or allow more parts",
      percent(error), percent(kDoubtful));
}

namespace {

/// Measures each part with its hull: visit(values of the parts) for each keyframe.
void measureParts(const Decomposition& decomposition, PoseView keyframes, const UsedHulls& hulls, const auto& measure,
                  const auto& visit) {
  std::vector<Vec3> points(decomposition.pointCount());
  std::vector<double> ofPart(decomposition.parts.size());
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    transfer(decomposition, keyframes.keyframe(k), points);
    parallelFor(ofPart.size(),
                [&](std::size_t i) { ofPart[i] = measure(hulls[k][i], points, decomposition.parts[i].triangles); });
    visit(std::as_const(ofPart));
  }
}

}  // namespace

double measureDistance(const Decomposition& decomposition, PoseView keyframes, const UsedHulls& hulls,
                       double ignoreBelow) {
  double worst = 0.0;
  measureParts(
      decomposition, keyframes, hulls,
      [&](const ConvexHull& hull, std::span<const Vec3> points, std::span<const Triangle> triangles) {
        return hullDistance(hull, points, triangles, ignoreBelow);
      },
      [&](const std::vector<double>& ofPart) { worst = std::max(worst, *std::ranges::max_element(ofPart)); });
  return worst;
}

Concavity measureConcavity(const Decomposition& decomposition, PoseView keyframes, const UsedHulls& hulls,
                           double ignoreBelow) {
  Concavity worst;
  measureParts(
      decomposition, keyframes, hulls,
      [&](const ConvexHull& hull, std::span<const Vec3> points, std::span<const Triangle> triangles) {
        return partConcavity(hull, points, triangles, ignoreBelow);
      },
      [&](const std::vector<double>& ofPart) {
        worst.largest = std::max(worst.largest, *std::ranges::max_element(ofPart));
        worst.mean = std::max(worst.mean, std::accumulate(ofPart.begin(), ofPart.end(), 0.0) / ofPart.size());
      });
  return worst;
}

HeldOutError heldOutError(const Character& character, const Decomposition& decomposition,
                          const std::optional<HullCover>& cover, const CoverPoses& poses) {
  constexpr int kEvery = 4;
  const BonePoseView all = poses.heldOutView();
  const int vertexCount = countOf(character.mesh.vertices);
  std::vector<Affine3> bones;
  std::vector<Vec3> positions;
  for (int p = 0; p < all.poseCount(); p += kEvery) {
    const std::span<const Affine3> pose = all.pose(p);
    bones.insert(bones.end(), pose.begin(), pose.end());
    positions.resize(positions.size() + vertexCount);
    skinLinearBlend(character, pose, std::span(positions).last(vertexCount));
  }
  const HullCover used = cover ? *cover : coverExactly(decomposition, liftPoints(character, decomposition));
  const UsedHulls hulls = liveHulls(character, decomposition, used, {bones, all.jointCount});
  const Quality quality = measureQuality(character.mesh, {positions, vertexCount}, hulls);
  return {quality.error, countOf(hulls)};
}

}  // namespace lorica
