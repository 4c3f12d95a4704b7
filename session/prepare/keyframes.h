#pragma once

#include "skinning/character.h"
#include "skinning/clip.h"

#include <span>
#include <vector>

namespace lorica {

/// The character's mesh in every frame of a motion.
/// @param motion  of the character's skeleton
/// @return positions [m], frameCount x vertexCount, frame-major
[[nodiscard]] std::vector<Vec3> poseAllFrames(const Character& character, const SkeletalMotion& motion);

/// Keyframes to train a decomposition: `count` frames taken uniformly over the motions laid end to end, the first and
/// the last included; one keyframe is the first frame.
/// @param motions  of the character's skeleton
/// @return positions [m], count x vertexCount, keyframe-major, or that there are fewer frames
[[nodiscard]] Result<std::vector<Vec3>> sampleKeyframes(const Character& character,
                                                        std::span<const SkeletalMotion> motions, int count);

/// Where a keyframe was taken from.
struct KeyframeSource {
  std::size_t motion = 0;
  std::size_t frame = 0;
  double time = 0.0;  ///< of the frame, in its motion [s]
};

struct ChosenKeyframes {
  std::vector<Vec3> positions;          ///< [m], count x vertexCount, keyframe-major
  std::vector<KeyframeSource> sources;  ///< one for each keyframe, in the order of the motions
  double farthest = 0.0;                ///< no frame differs more than this from the keyframe most like it [m]
};

/// Keyframes that differ most: the first frame of all, then again and again the frame that differs most from all chosen
/// so far, until there are `atMost` or none differs by more than `closeEnough`. What a pose is as a whole, where it
/// stands and turns to, does not count: two frames differ by the root mean square distance of their vertices (300 of
/// them) after one body was moved rigidly onto the other as well as it goes. Of motions with more than 10,000 frames
/// in all, that many are looked at, taken evenly.
/// @param motions      of the character's skeleton
/// @param atMost       1 or more
/// @param closeEnough  [m], 0 or more
/// @return the keyframes, or that there is no frame
[[nodiscard]] Result<ChosenKeyframes> chooseKeyframes(const Character& character,
                                                      std::span<const SkeletalMotion> motions, int atMost,
                                                      double closeEnough);

}  // namespace lorica
