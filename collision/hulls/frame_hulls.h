#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "acd/transfer.h"
#include "geometry/convex_hull.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// The hulls of a decomposition in every frame of motions.
struct FrameHulls {
  int pointCount = 0;                          ///< of the decomposition
  std::vector<Vec3> points;                    ///< frameCount x pointCount, frame-major [m]
  std::vector<std::vector<ConvexHull>> hulls;  ///< of each frame, one a part, over the points of the part
  std::vector<PoseError> errors;               ///< of each frame
  std::vector<double> times;                   ///< of each frame, in its motion [s]

  /// The points of a frame.
  [[nodiscard]] std::span<const Vec3> frame(std::size_t index) const {
    return std::span(points).subspan(index * pointCount, pointCount);
  }
};

/// The mean of relative() over frames. @param errors  at least one
[[nodiscard]] double meanErrorOf(std::span<const PoseError> errors);

/// The frames whose mesh is that of a keyframe, ascending. @param keyframes  of the same mesh
[[nodiscard]] std::vector<int> keyframesAmong(const FrameHulls& frames, PoseView keyframes);

/// The mesh of a character in a frame of a motion. @param posed  a position for each vertex [m], written
void poseInFrame(const Character& character, const SkeletalMotion& motion, int frame, std::span<Vec3> posed);

/// Transfers a decomposition to all frames, see transfer(), and makes the hulls of the parts.
/// @param held      of the character's mesh, with the vertices that no part contains
/// @param motions   of the character's skeleton
/// @param progress  gets the frames that are done; returns false to stop
/// @return the hulls, or kCancelled
[[nodiscard]] Result<FrameHulls> hullsOfFrames(const Character& character, const Decomposition& held,
                                               std::span<const SkeletalMotion> motions, int threads,
                                               const std::function<bool(int done, int frames)>& progress = {});

}  // namespace lorica
