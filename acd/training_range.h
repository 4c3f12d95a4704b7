#pragma once

#include "acd/decomposition.h"

#include <span>
#include <vector>

namespace lorica {

inline constexpr std::size_t kMaxProbes = 128;  ///< points that stand for a pose

/// A compact record of the poses that a decomposition was trained on: the positions of a few of its points, the probes,
/// in each keyframe. Measures how far a pose is from all of them. Outside the training range the hulls still cover the
/// body, but may fit it loosely.
struct TrainingRange {
  std::vector<PointIndex> probes;  ///< distributed over all parts; 1 to kMaxProbes, no duplicates
  int keyframeCount = 0;           ///< 1 or more
  std::vector<Vec3> positions;     ///< keyframeCount x probes, keyframe-major, relative to each keyframe's centroid [m]
  double knownDistance = 0.0;      ///< poses up to this distance from the nearest keyframe are in range [m]

  /// The probes in training keyframe `k` [m].
  [[nodiscard]] std::span<const Vec3> keyframe(int k) const {
    return std::span(positions).subspan(k * probes.size(), probes.size());
  }
};

/// Creates a training range. Chooses four probes per part, but at least 32 in total if there are enough points, and at
/// most 128: from each part in turn the point farthest from the part's probes so far, in the first keyframe.
///
/// `knownDistance` is 0.3 of the probes' root mean square distance from their centroid, a heuristic: on the built-in
/// character, where that distance is 0.55 m, the hulls fitted as closely 0.15 m from the nearest keyframe as in
/// keyframes (relative volume error 0.10), and more loosely from 0.2 m on (0.11 to 0.13). If all frames of the training
/// motions are available, use farthestFrame() if it is larger.
/// @param decomposition  with at least one part that has points
/// @param keyframes      of the mesh, at least one [m]
[[nodiscard]] TrainingRange trainingRange(const Decomposition& decomposition, PoseView keyframes);

/// Returns the distance of a pose from the most similar training keyframe: root mean square distance of the probes
/// after the best rigid alignment, so global position and orientation have no effect [m]. Infinite if the pose is not
/// finite. Does not allocate.
/// @param probePositions  positions of the probes in this pose, in their order [m]
[[nodiscard]] double trainingDistance(const TrainingRange& range, std::span<const Vec3> probePositions);

/// Copies the positions of the probes from the points of a pose.
/// @param points          pointCount positions, see transfer() [m]
/// @param probePositions  output, one for each probe [m]
void gatherProbes(const TrainingRange& range, std::span<const Vec3> points, std::span<Vec3> probePositions);

/// Returns the largest trainingDistance() over all frames of a motion. The maximum over all training motions, used as
/// `knownDistance`, puts every frame of these motions within the training range.
/// @param frames  of the mesh [m]
[[nodiscard]] double farthestFrame(const TrainingRange& range, const Decomposition& decomposition, PoseView frames);

}  // namespace lorica
