#include "collision/hulls/file_content.h"

#include "acd/level_of_detail.h"
#include "acd/training_range.h"
#include "collision/hulls/keyframes.h"
#include "collision/hulls/quality.h"
#include "collision/live/part_bones.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/threads.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kMaxKnownFrames = 3000;

/// Largest distance of a training frame from its nearest keyframe [m].
double farthestTrained(const TrainingRange& range, const Decomposition& decomposition, const Character& character,
                       const Training& training) {
  std::size_t frameCount = 0;
  for (const SkeletalMotion& motion : training.motions) frameCount += motion.times.size();
  const std::size_t stride = (frameCount + kMaxKnownFrames - 1) / kMaxKnownFrames;
  double farthest = 0.0;
  for (const SkeletalMotion& motion : training.motions) {
    SkeletalMotion one{motion.name, motion.skeleton, {0.0}, {}};
    for (std::size_t f = 0; f < motion.times.size(); f += stride) {
      const std::span<const JointTransform> pose = motion.pose(f);
      one.poses.assign(pose.begin(), pose.end());
      const std::vector<Vec3> posed = poseAllFrames(character, one);
      farthest = std::max(farthest, farthestFrame(range, decomposition, {posed, countOf(posed)}));
    }
  }
  return farthest;
}

}  // namespace

UsedHulls liveHulls(const Character& character, const Decomposition& decomposition, const HullCover& cover,
                    BonePoseView poses) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  UsedHulls hulls(poses.poseCount());
  parallelFor(poses.poseCount(), [&](int k) {
    std::vector<Vec3> positions;
    for (const std::vector<CoverPoint>& points : cover.points) {
      positions.clear();
      for (const CoverPoint& p : points) {
        positions.push_back(positionOf(pushed(lifted[p.point], p.outward), poses.pose(k)));
      }
      hulls[k].push_back(convexHull(positions));
    }
  });
  return hulls;
}

DecompositionFile fileContent(const std::string& name, const TriMesh& mesh, const Character* character,
                              const Training* training, PoseView keyframes, Decomposition decomposition,
                              const UsedHulls& hulls) {
  const Quality quality = measureQuality(mesh, keyframes, hulls);
  DecompositionFile content;
  content.source = name;
  content.meshHash = topologyHash(mesh);
  content.meanError = quality.error;
  content.errorPerKeyframe = quality.errorPerKeyframe;
  content.detailLevels = detailLevels(decomposition, mesh, keyframes, hulls);
  if (character != nullptr) content.bonesOfPart = bonesOfParts(decomposition, *character);
  if (character != nullptr || keyframes.keyframeCount() > 1) content.training = trainingRange(decomposition, keyframes);
  if (character != nullptr && training != nullptr) {
    content.training->knownDistance = std::max(
        content.training->knownDistance, farthestTrained(*content.training, decomposition, *character, *training));
  }
  content.decomposition = std::move(decomposition);
  return content;
}

Result<void> checkMadeFrom(const Subject& subject, const DecompositionFile& content, const std::string& from) {
  if (content.meshHash == topologyHash(subject.mesh)) return {};
  return invalidArgument("{}: made from {} ({} vertices), expected a decomposition of {} ({} vertices)", from,
                         content.source, grouped(content.decomposition.vertexCount), subject.name,
                         grouped(std::ssize(subject.mesh.vertices)));
}

Result<DecompositionFile> readDecompositionOf(const Subject& subject, const std::filesystem::path& file) {
  LORICA_TRY(DecompositionFile read, readDecomposition(file));
  LORICA_TRY_DO(checkMadeFrom(subject, read, file.string()));
  return read;
}

}  // namespace lorica
