#pragma once

#include "skinning/import/file_scene.h"

namespace lorica {

/// Gives the bones of a skin that an FBX or COLLADA file lists side by side, without a hierarchy, the parents that
/// their names mean, as files of tools for Second Life need. Each stays where it is. Adds a note.
void hangFlatBones(FileScene& scene);

/// Gives a humanoid of rigid meshes a skin of its bones, which moves nothing: each mesh follows its node. For a file
/// without skins and clips whose humanoid bones are listed, or known by their names. Adds a note.
void addRigidSkin(FileScene& scene);

}  // namespace lorica
