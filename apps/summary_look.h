#pragma once

#include "apps/report.h"
#include "skinning/import/character_file.h"
#include "skinning/look/look.h"

#include <nlohmann/json.hpp>

#include <span>

namespace lorica {

/// Names of meshes for `lorica info`, as --hide takes them.
void describeMeshNames(std::span<const MeshName> meshes, Report& report, nlohmann::ordered_json& json);

/// Materials and pictures for `lorica info`, and the memory of the textures.
/// @param textureSize  largest side of textures [pixels]; 0 = as stored
void describeLook(const Look& look, int textureSize, Report& report, nlohmann::ordered_json& json);

}  // namespace lorica
