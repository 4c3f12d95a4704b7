#include "acd/level_of_detail.h"

#include "acd/piece.h"
#include "acd/transfer.h"
#include "geometry/counts.h"
#include "geometry/threads.h"

#include <algorithm>

namespace lorica {
namespace {

/// Values of all levels in one keyframe; entry n - 1 is for n parts.
struct LevelsInPose {
  std::vector<double> error;
  std::vector<int> hullVertices;
};

LevelsInPose judge(const Decomposition& decomposition, double meshVolume, std::vector<ConvexHull> hulls) {
  // From the finest level to the coarsest: merge the last part into the part that it was split from. The hull of both
  // is the hull of their hulls' vertices.
  LevelsInPose levels{std::vector<double>(hulls.size()), std::vector<int>(hulls.size())};
  while (!hulls.empty()) {
    const std::size_t n = hulls.size();
    double volume = 0.0;
    for (const ConvexHull& hull : hulls) {
      volume += hull.volume;
      levels.hullVertices[n - 1] += countOf(hull.vertices);
    }
    levels.error[n - 1] = (volume - meshVolume) / meshVolume;
    if (n > 1) {
      ConvexHull& parent = hulls[decomposition.splitFrom[n - 2]];
      std::vector<Vec3> both = std::move(parent.vertices);
      both.insert(both.end(), hulls.back().vertices.begin(), hulls.back().vertices.end());
      parent = convexHull(both);
    }
    hulls.pop_back();
  }
  return levels;
}

}  // namespace

Decomposition levelOfDetail(const Decomposition& decomposition, int partCount) {
  const std::size_t wanted = partCount;
  LORICA_CHECK(partCount >= 1 && wanted <= decomposition.parts.size(), "partCount must be 1 to the number of parts");
  // Find the part of the level that each part belongs to. A part is split from an earlier part, so one pass is enough.
  std::vector<std::vector<const Part*>> members(wanted);
  std::vector<std::size_t> levelPartOf(decomposition.parts.size());
  for (std::size_t i = 0; i < decomposition.parts.size(); ++i) {
    levelPartOf[i] = i < wanted ? i : levelPartOf[decomposition.splitFrom[i - 1]];
    members[levelPartOf[i]].push_back(&decomposition.parts[i]);
  }
  Decomposition level;
  level.vertexCount = decomposition.vertexCount;
  level.triangleCount = decomposition.triangleCount;
  level.cutPoints = decomposition.cutPoints;
  level.splitFrom.assign(decomposition.splitFrom.begin(), decomposition.splitFrom.begin() + (partCount - 1));
  level.parts.reserve(wanted);
  for (const std::vector<const Part*>& group : members) {
    level.parts.push_back(group.size() == 1 ? *group.front() : unite(group));
  }
  return level;
}

std::vector<std::vector<ConvexHull>> hullsOfParts(const Decomposition& decomposition, PoseView keyframes) {
  std::vector<std::vector<ConvexHull>> hulls(keyframes.keyframeCount());
  parallelFor(keyframes.keyframeCount(), [&](int k) {
    std::vector<Vec3> points(decomposition.pointCount());
    transfer(decomposition, keyframes.keyframe(k), points);
    hulls[k] = partHulls(decomposition, points);
  });
  return hulls;
}

std::vector<DetailLevel> detailLevels(const Decomposition& decomposition, const TriMesh& mesh, PoseView keyframes,
                                      std::span<const std::vector<ConvexHull>> hulls) {
  LORICA_CHECK(keyframes.keyframeCount() > 0, "detailLevels() needs at least one keyframe");
  std::vector<LevelsInPose> poses(keyframes.keyframeCount());
  parallelFor(keyframes.keyframeCount(), [&](int k) {
    poses[k] = judge(decomposition, signedVolume(keyframes.keyframe(k), mesh.triangles), hulls[k]);
  });
  std::vector<DetailLevel> detailLevels(decomposition.parts.size());
  const double share = 1.0 / keyframes.keyframeCount();
  for (std::size_t n = 0; n < detailLevels.size(); ++n) {
    detailLevels[n].worstError = poses[0].error[n];
    for (const LevelsInPose& pose : poses) {
      detailLevels[n].meanError += share * pose.error[n];
      detailLevels[n].worstError = std::max(detailLevels[n].worstError, pose.error[n]);
      detailLevels[n].hullVertices = std::max(detailLevels[n].hullVertices, pose.hullVertices[n]);
    }
  }
  return detailLevels;
}

}  // namespace lorica
