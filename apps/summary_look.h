#pragma once

#include "apps/report.h"
#include "skinning/look/look.h"

#include <nlohmann/json.hpp>

namespace lorica {

/// Meshes, materials and pictures for `lorica info`, and the memory of the textures.
/// @param textureSize  largest side of textures [pixels]; 0 = as stored
void describeLook(const Look& look, int textureSize, Report& report, nlohmann::ordered_json& json);

}  // namespace lorica
