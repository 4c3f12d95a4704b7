#pragma once

#include "acd/decomposition_file.h"
#include "prepare/training.h"
#include "prepare/used_hulls.h"

#include <string>

namespace lorica {

/// The content of a .lorica file for a new decomposition: levels of detail evaluated in the keyframes, the training
/// range, and the bones that move each part; no cover. The training range contains all frames of the training motions;
/// of more than 3,000 frames, that many at even intervals are considered.
/// @param character  null for a mesh, as is training
/// @param hulls      those that are used, of the parts, in each keyframe
[[nodiscard]] DecompositionFile fileContent(const std::string& name, const TriMesh& mesh, const Character* character,
                                            const Training* training, PoseView keyframes, Decomposition decomposition,
                                            const UsedHulls& hulls);

}  // namespace lorica
