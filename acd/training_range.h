#pragma once

#include "acd/decomposition.h"

#include <span>
#include <vector>

namespace lorica {

inline constexpr std::size_t kMaxProbes = 128;

/// What poses trained a decomposition, in small: where a few of its points, the probes, were in each keyframe. Tells
/// how far a pose is from all of them. A decomposition is as good as its training; where training never went, the hulls
/// still cover the body, but may stand far off it.
struct TrainingRange {
  std::vector<PointIndex> probes;  ///< spread over every part; 1 to kMaxProbes, each once
  int keyframeCount = 0;           ///< 1 or more
  std::vector<Vec3> positions;     ///< keyframeCount x probes, keyframe-major, each keyframe about its centroid [m]
  double knownDistance = 0.0;      ///< poses up to this far from the nearest keyframe count as known [m]

  [[nodiscard]] std::span<const Vec3> keyframe(int k) const {
    return std::span(positions).subspan(static_cast<std::size_t>(k) * probes.size(), probes.size());
  }
};

/// Chooses four probes of each part, but 32 in all or more where there are so many points, and no more than 128: of
/// each part in turn the point farthest from those of the part chosen so far, in the first keyframe.
///
/// `knownDistance` is 0.3 of the probes' root mean square distance from their centroid, a rule of thumb: on the
/// built-in character, of 0.55 m, the hulls were as close 0.15 m from the nearest keyframe as in keyframes (relative
/// volume error 0.10), and from 0.2 m on looser (0.11 to 0.13). Who has all frames of the training motions takes
/// farthestFrame() where that is more.
/// @param decomposition  with at least one part that has points
/// @param keyframes      of the mesh, at least one [m]
[[nodiscard]] TrainingRange trainingRange(const Decomposition& decomposition, PoseView keyframes);

/// How far a pose is from the training keyframe most like it: root mean square distance of the probes after the best
/// rigid motion, so that where a body stands and turns to does not count [m]. Infinite where the pose is not finite.
/// Allocates nothing.
/// @param probePositions  where the probes are in this pose, in their order [m]
[[nodiscard]] double trainingDistance(const TrainingRange& range, std::span<const Vec3> probePositions);

/// Picks the probes from the points of a pose.
/// @param points          pointCount positions, see transfer() [m]
/// @param probePositions  as many as probes, written [m]
void gatherProbes(const TrainingRange& range, std::span<const Vec3> points, std::span<Vec3> probePositions);

/// The largest trainingDistance() of all frames of a motion; of several motions the largest counts. As `knownDistance`
/// it makes every frame of the training motions a known pose.
/// @param frames  of the mesh [m]
[[nodiscard]] double farthestFrame(const TrainingRange& range, const Decomposition& decomposition, PoseView frames);

}  // namespace lorica
