#pragma once

#include "skinning/import/file_scene.h"

#include <cstddef>
#include <filesystem>
#include <span>

namespace lorica {

/// Reads glTF 2.0, GLB and VRM.
/// @param folder  where other files are searched; empty: other files are not read
[[nodiscard]] Result<FileScene> readGltfScene(std::span<const std::byte> bytes, const std::string& name,
                                              const std::filesystem::path& folder);

}  // namespace lorica
