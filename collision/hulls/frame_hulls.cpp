#include "collision/hulls/frame_hulls.h"

#include "geometry/errors.h"
#include "geometry/parallel_progress.h"
#include "skinning/linear_blend.h"

#include <algorithm>

namespace lorica {

double meanErrorOf(std::span<const PoseError> errors) {
  double sum = 0.0;
  for (const PoseError& error : errors) sum += error.relative();
  return sum / static_cast<double>(errors.size());
}

std::vector<int> keyframesAmong(const FrameHulls& frames, PoseView keyframes) {
  std::vector<int> found;
  for (std::size_t f = 0; f < frames.hulls.size(); ++f) {
    const std::span<const Vec3> posed = frames.frame(f).first(keyframes.vertexCount);
    for (int k = 0; k < keyframes.keyframeCount(); ++k) {
      if (!std::ranges::equal(posed, keyframes.keyframe(k))) continue;
      found.push_back(static_cast<int>(f));
      break;
    }
  }
  return found;
}

void poseInFrame(const Character& character, const SkeletalMotion& motion, int frame, std::span<Vec3> posed) {
  std::vector<Affine3> bones(character.skeleton.jointCount());
  computeWorldFromJoint(character.skeleton, motion.pose(frame), bones);
  computeWorldFromModel(character, bones, bones);
  skinLinearBlend(character, bones, posed);
}

Result<FrameHulls> hullsOfFrames(const Character& character, const Decomposition& held,
                                 std::span<const SkeletalMotion> motions, int threads,
                                 const std::function<bool(int done, int frames)>& progress) {
  FrameHulls made;
  std::vector<std::pair<const SkeletalMotion*, int>> frames;
  for (const SkeletalMotion& motion : motions) {
    for (int f = 0; f < motion.frameCount(); ++f) frames.emplace_back(&motion, f);
    made.times.insert(made.times.end(), motion.times.begin(), motion.times.end());
  }
  made.pointCount = held.pointCount();
  made.points.resize(frames.size() * made.pointCount);
  made.hulls.resize(frames.size());
  made.errors.resize(frames.size());
  const bool whole = inParallel(frames.size(), threads, progress, [&](std::size_t f) {
    const std::span<Vec3> points = std::span(made.points).subspan(f * made.pointCount, made.pointCount);
    const std::span<Vec3> posed = points.first(held.vertexCount);
    poseInFrame(character, *frames[f].first, frames[f].second, posed);
    transfer(held, posed, points);
    made.hulls[f] = partHulls(held, points);
    PoseError& error = made.errors[f];
    for (const ConvexHull& hull : made.hulls[f]) error.hullVolume += hull.volume;
    // As in measureQuality(): a surface that overlaps itself counts some volume twice.
    error.meshVolume = std::min(signedVolume(posed, character.mesh.triangles), error.hullVolume);
  });
  if (!whole) return cancelled();
  return made;
}

}  // namespace lorica
