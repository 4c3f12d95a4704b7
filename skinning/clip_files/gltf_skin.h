#pragma once

#include "skinning/character.h"
#include "skinning/clip_files/gltf_writer.h"
#include "skinning/look/look.h"

#include <span>

namespace lorica {

/// Adds a whole character: a node for each joint, in their order and at rest, and a node with the skinned mesh.
/// @param skeleton   of the joints to write
/// @param jointFromModel  inverse bind matrices of these joints
/// @param firstJoint      index in the character of the first of them; no vertex may follow an earlier one
/// @param look            of the character's mesh; may be empty
void addCharacter(GltfWriter& writer, const Character& character, const Look& look, const Skeleton& skeleton,
                  std::span<const Affine3> jointFromModel, JointIndex firstJoint);

}  // namespace lorica
