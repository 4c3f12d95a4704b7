#pragma once

#include "collision/hulls/host.h"
#include "geometry/arrays/mesh_sequence.h"
#include "skinning/import/character_file.h"

#include <string>
#include <vector>

namespace lorica {

/// CharacterFile::format of a mesh in several poses.
inline constexpr const char* kSequence = "mesh sequence";

/// A mesh in several poses as a character that plays them: in the unit and axes of its files. A single pose is a mesh,
/// see CharacterFile::isMesh().
[[nodiscard]] Result<CharacterFile> playedFile(MeshSequence sequence);

/// Reads what kindOf() calls a character: its file, see readCharacterFile(), or a mesh in several poses, see
/// readMeshSequence().
/// @param hidden  see CharacterFileSettings
[[nodiscard]] Result<CharacterFile> readPlayed(const std::string& input, Host& host,
                                               std::vector<std::string> hidden = {});

}  // namespace lorica
