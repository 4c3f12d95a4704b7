#pragma once

#include "geometry/named_file.h"
#include "skinning/import/file_scene.h"

#include <cstddef>
#include <span>
#include <string>

namespace lorica {

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

}  // namespace lorica
