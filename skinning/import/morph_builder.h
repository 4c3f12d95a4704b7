#pragma once

#include "skinning/import/bind_frames.h"
#include "skinning/import/file_scene.h"

#include <span>

namespace lorica {

/// The morph targets in metres and Lorica's axes, over the vertices of all meshes in their order. Vertices that move
/// less than 0.1 micrometres and turn less than 1e-5 are left out.
/// @param modelFromFile  the bind pose's units and axes
[[nodiscard]] Morphs makeMorphs(const FileScene& scene, const BindFrames& frames, const Affine3& modelFromFile);

/// The scene's gaze with joints; none if nothing of the character could follow it.
/// @param jointOfNode  for each node its joint, or kNoJoint
[[nodiscard]] LookAt makeLookAt(const FileScene& scene, const Skeleton& skeleton,
                                std::span<const JointIndex> jointOfNode);

}  // namespace lorica
