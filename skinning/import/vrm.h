#pragma once

#include "skinning/import/file_scene.h"

#include <nlohmann/json_fwd.hpp>

namespace lorica {

/// Reads what VRM 0.x ("VRM"), 1.0 ("VRMC_vrm") or a VRM animation ("VRMC_vrm_animation") adds to a glTF file: the
/// format name, the humanoid bones, and the facing direction -Z of 0.x. Bones that refer to no node are skipped, with a
/// note. https://github.com/vrm-c/vrm-specification: 0.0/README.md and VRMC_vrm-1.0/humanoid.md
/// @param extensions  those of the whole file, an object
/// @param scene       its nodes are read; format, bones, axes and notes are written
void readVrm(const nlohmann::json& extensions, FileScene& scene);

}  // namespace lorica
