#pragma once

#include "capture/streams/bone_stream.h"
#include "session/pose_source.h"
#include "skinning/character.h"

#include <memory>

namespace lorica {

/// Poses a character with what another program sends, see StreamRetargeter. Never ends.
///
/// Without new frames the pose is held, and time goes on in steps of at most 1/30 s. After half a second of silence, or
/// while the sender says that it is not tracking, the trust of all joints is 0. It is also 0 for limbs that the sender
/// leaves out. It recovers within 0.3 s.
/// @return the source, or an error with the humanoid bones that the character lacks
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeStreamPoseSource(const Character& character,
                                                                       std::unique_ptr<BoneStream> stream, bool mirror);

}  // namespace lorica
