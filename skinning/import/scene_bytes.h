#pragma once

#include "skinning/import/file_scene.h"

#include <string>
#include <string_view>

namespace lorica {

/// What AssimpSceneReader fills of a scene as bytes, to hand it from one process of this program to another. Numbers
/// keep their bits. Not a file format: both processes run the same program.
[[nodiscard]] std::string encodeScene(const FileScene& scene);

/// The scene of encodeScene(). The bytes may come from a process that a hostile file has taken over: every length is
/// checked against what is left, and every promise of FileScene before it is returned.
/// @param name  of the file, for messages
[[nodiscard]] Result<FileScene> decodeScene(std::string_view bytes, const std::string& name);

}  // namespace lorica
