#pragma once

#include "skinning/import/file_scene.h"

#include <nlohmann/json_fwd.hpp>

namespace lorica {

/// Takes what VRM 0.x ("VRM") or 1.0 ("VRMC_vrm") adds to a glTF file: its name, its humanoid bones, and that 0.x faces
/// -Z. Bones that name no node are left out, with a note.
/// https://github.com/vrm-c/vrm-specification: 0.0/README.md and VRMC_vrm-1.0/humanoid.md
/// @param extensions  those of the whole file, an object
/// @param scene       its nodes are read; format, bones, axes and notes are written
void readVrm(const nlohmann::json& extensions, FileScene& scene);

}  // namespace lorica
