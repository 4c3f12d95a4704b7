#pragma once

#include "skinning/import/file_scene.h"

#include <cstddef>
#include <span>

namespace lorica {

enum class AssimpFormat { kFbx, kCollada };

/// Reads FBX (text and binary) or COLLADA through assimp.
///
/// Unit and axes are what the file says; FBX without them is in centimetres, Y up. Keys are taken as linear, which is
/// how assimp gives them. FBX pivots are folded into their nodes: the other way that assimp offers makes up to six
/// nodes of one bone, and put the hips of the clips at hand 5 m away from where the file has them.
[[nodiscard]] Result<FileScene> readAssimpScene(std::span<const std::byte> bytes, const std::string& name,
                                                AssimpFormat format);

}  // namespace lorica
