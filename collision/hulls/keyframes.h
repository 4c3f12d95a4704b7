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

/// Keyframes to train a decomposition: `count` frames at even intervals over the concatenated motions, including the
/// first and the last; a single keyframe is the first frame.
/// @param motions  of the character's skeleton
/// @return positions [m], count x vertexCount, keyframe-major, or an error if there are fewer frames
[[nodiscard]] Result<std::vector<Vec3>> sampleKeyframes(const Character& character,
                                                        std::span<const SkeletalMotion> motions, int count);

/// The bones in the keyframes of sampleKeyframes(), for as many frames as there are at least.
/// @return worldFromModel, count x jointCount, pose-major
[[nodiscard]] std::vector<Affine3> sampleBones(const Character& character, std::span<const SkeletalMotion> motions,
                                               int count);

/// The frame that a keyframe was taken from.
struct KeyframeSource {
  std::size_t motion = 0;  ///< index of the motion
  std::size_t frame = 0;   ///< of that motion
  double time = 0.0;       ///< of the frame, in its motion [s]
};

/// Poses of a character's mesh that differ as much as possible.
struct ChosenKeyframes {
  std::vector<Vec3> positions;          ///< [m], count x vertexCount, keyframe-major
  std::vector<KeyframeSource> sources;  ///< one for each keyframe, in the order of the motions
  std::vector<Affine3> worldFromModel;  ///< of the bones in each keyframe, count x jointCount
  double farthest = 0.0;                ///< maximum distance of a frame to its nearest keyframe [m]
};

/// Chooses the most different keyframes: the first frame, then repeatedly the frame that is most distant from all
/// chosen ones, until there are `atMost` or no frame is more distant than `closeEnough`. The distance ignores the
/// position and orientation of the body: it is the root mean square distance of 300 vertices after the best rigid
/// alignment. If the motions have more than 10,000 frames in total, 10,000 frames at even intervals are considered.
/// @param motions      of the character's skeleton
/// @param atMost       maximum number of keyframes, at least 1
/// @param closeEnough  [m], at least 0
/// @return the keyframes, or an error if there are no frames
[[nodiscard]] Result<ChosenKeyframes> chooseKeyframes(const Character& character,
                                                      std::span<const SkeletalMotion> motions, int atMost,
                                                      double closeEnough);

/// The same of poses that are given by their bones. @param worldFromModel  poses x jointCount, at least one pose
[[nodiscard]] ChosenKeyframes chooseAmongPoses(const Character& character, std::span<const Affine3> worldFromModel,
                                               int atMost, double closeEnough);

}  // namespace lorica
