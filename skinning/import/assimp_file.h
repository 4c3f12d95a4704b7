#pragma once

#include "skinning/import/file_scene.h"

#include <cstddef>
#include <filesystem>
#include <span>

namespace lorica {

enum class AssimpFormat { kFbx, kCollada };

/// Reads FBX (text and binary) or COLLADA through assimp.
///
/// Unit and axes are those of the file; FBX without them is in centimetres, Y up. Keys are interpolated linearly, as
/// assimp provides them. FBX pivots are folded into their nodes: assimp's alternative creates up to six nodes per bone,
/// and placed the hips of our test clips 5 m away from their position in the file.
/// @param folder  where pictures of materials are searched; empty: other files are not read
[[nodiscard]] Result<FileScene> readAssimpScene(std::span<const std::byte> bytes, const std::string& name,
                                                AssimpFormat format, const std::filesystem::path& folder);

}  // namespace lorica
