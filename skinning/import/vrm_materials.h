#pragma once

#include "skinning/look/material.h"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <vector>

namespace lorica {

/// The texture of an index in the file's list, with its sampler; not given if there is none.
using TextureOfIndex = std::function<TextureUse(int texture)>;

/// Applies VRMC_materials_mtoon, an extension of one glTF material, to what the rest of it gave.
/// https://github.com/vrm-c/vrm-specification/blob/master/specification/VRMC_materials_mtoon-1.0/README.md
/// @param use  reads a glTF textureInfo
void applyMtoon1(const nlohmann::json& mtoon, const std::function<TextureUse(const nlohmann::json&)>& use,
                 Material& material);

/// Applies the list VRM.materialProperties of VRM 0.x, whose element i belongs to material i: MToon 0.x and the unlit
/// shaders of UniVRM, converted to MToon 1.0 as https://github.com/vrm-c/UniVRM does. Colours there are gamma-encoded.
void applyVrm0Materials(const nlohmann::json& properties, const TextureOfIndex& textureOf,
                        std::vector<Material>& materials);

}  // namespace lorica
