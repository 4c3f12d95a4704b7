#pragma once

#include "geometry/named_file.h"
#include "skinning/import/file_scene.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <span>
#include <string>

// From the bytes of a file to its content, one function for each kind of file.

namespace lorica {

/// Reads glTF 2.0, GLB and VRM.
/// @param files  where other files are searched; an empty folder: other files are not read
[[nodiscard]] Result<FileScene> readGltfScene(std::span<const std::byte> bytes, const std::string& name,
                                              const NamedFiles& files);

enum class AssimpFormat { kFbx, kCollada };

/// Reads FBX (text and binary) or COLLADA through assimp.
///
/// Unit and axes are those of the file; FBX without them is in centimetres, Y up. Keys are interpolated linearly, as
/// assimp provides them. FBX pivots are folded into their nodes: assimp's alternative creates up to six nodes per bone,
/// and placed the hips of our test clips 5 m away from their position in the file.
/// What assimp does with a hostile file cannot be bounded in here: see IsolatedReader.
/// @param files  where pictures of materials are searched; an empty folder: other files are not read
/// @return the scene without its expressions
[[nodiscard]] Result<FileScene> readAssimpScene(std::span<const std::byte> bytes, const std::string& name,
                                                AssimpFormat format, const NamedFiles& files);

/// Reads expressions and gaze of VRM 0.x (blendShapeMaster, firstPerson) or 1.0 (expressions, lookAt). In a file
/// without VRM data every morph target becomes an expression by its own name; targets of the same name become one.
/// https://github.com/vrm-c/vrm-specification: 0.0/README.md, VRMC_vrm-1.0/expressions.md and lookAt.md
///
/// Binds to morph targets and materials that do not exist are skipped, with a note.
/// @param extensions  those of the whole file, an object
/// @param scene       its morph targets and materials are read; expressions, gaze and notes are written
void readExpressions(const nlohmann::json& extensions, FileScene& scene);

}  // namespace lorica
