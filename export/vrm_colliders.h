#pragma once

#include "export/rigid_colliders.h"
#include "skinning/clip_files/character_document.h"
#include "skinning/springs/spring_bones.h"

#include <string>

namespace lorica {

/// Adds spring-bone colliders to the document of a VRM file, in a group that every spring uses: hair and clothes keep
/// out of the body. Each hull becomes the capsule around it, shrunk to the hull's volume, since a capsule that holds
/// all poses would push away what rests on the skin; VRM 0.x has only balls, so a capsule becomes a row of them. Bones
/// that swing themselves get none. Nothing else of the document changes.
/// @param springs  of the file
/// @return the number of shapes added; or that the file is no VRM or has no springs
[[nodiscard]] Result<int> addSpringColliders(CharacterDocument& document, std::span<const RigidCollider> colliders,
                                             const Skeleton& skeleton, const SpringBones& springs,
                                             const std::string& name);

}  // namespace lorica
