#pragma once

#include "skinning/import/file_scene.h"

#include <string>

namespace lorica {

/// Checks every promise that FileScene makes about nodes, skins, meshes, clips, morph targets and materials.
/// @param name  of the file, for messages
[[nodiscard]] Result<void> checkScene(const FileScene& scene, const std::string& name);

}  // namespace lorica
