#pragma once

#include "skinning/import/file_scene.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// The material of colliders in files that `lorica export` wrote.
inline constexpr const char* kColliderMaterial = "lorica_collider";

/// The meshes of a file and their nodes, each pair once: the first 1,000.
[[nodiscard]] std::vector<MeshName> meshNamesOf(const FileScene& scene);

/// Takes meshes out of a scene, see CharacterFileSettings::hidden, and colliders of `lorica export`, which are no part
/// of a character.
/// @param fileName  for messages
/// @return the meshes; or an error if a name is unknown, which lists the known ones, or if no mesh is left
[[nodiscard]] Result<std::vector<FileMesh>> takeHiddenMeshes(FileScene& scene, std::span<const std::string> hidden,
                                                             const std::string& fileName);

}  // namespace lorica
