#pragma once

#include "capture/skeleton_frame.h"
#include "skinning/character.h"

#include <span>
#include <vector>

namespace lorica {

/// Poses a character by every frame of a recording, as a session would.
/// @return positions [m], frameCount x vertexCount, frame-major, or why the character cannot be posed
[[nodiscard]] Result<std::vector<Vec3>> poseAllFrames(const Character& character,
                                                      std::span<const SkeletonFrame> recording);

/// Keyframes to train a decomposition: `count` frames taken uniformly over the recordings laid end to end, the first
/// and the last included; one keyframe is the first frame. Each recording is posed from its start, as a session does.
/// @return positions [m], count x vertexCount, keyframe-major, or that there are fewer frames, or why the character
///         cannot be posed
[[nodiscard]] Result<std::vector<Vec3>> sampleKeyframes(const Character& character,
                                                        std::span<const std::vector<SkeletonFrame>> recordings,
                                                        int count);

}  // namespace lorica
