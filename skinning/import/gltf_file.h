#pragma once

#include "geometry/named_file.h"
#include "skinning/import/file_scene.h"

#include <cstddef>
#include <span>
#include <string>

namespace lorica {

/// Reads glTF 2.0, GLB and VRM.
/// @param files  where other files are searched; an empty folder: other files are not read
[[nodiscard]] Result<FileScene> readGltfScene(std::span<const std::byte> bytes, const std::string& name,
                                              const NamedFiles& files);

}  // namespace lorica
