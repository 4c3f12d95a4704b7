#pragma once

#include "skinning/import/json_values.h"
#include "skinning/look/material.h"

#include <cstdint>
#include <functional>
#include <set>

namespace lorica {

/// The texture of an index in the file's list, with its sampler; not given if there is none.
using TextureOfIndex = std::function<TextureUse(std::int64_t texture)>;

/// Applies VRMC_materials_mtoon, an extension of one glTF material, to what the rest of it gave.
/// https://github.com/vrm-c/vrm-specification/blob/master/specification/VRMC_materials_mtoon-1.0/README.md
/// @param use  reads a glTF textureInfo
void applyMtoon1(const nlohmann::json& mtoon, const std::function<TextureUse(const nlohmann::json&)>& use,
                 MemberReader& members, Material& material);

/// The render queues of all blended materials of a VRM 0.x file: only their ranks among each other count.
struct Vrm0Queues {
  std::set<int> withDepth, withoutDepth;
};
[[nodiscard]] Vrm0Queues queuesOf(const nlohmann::json& allProperties);

/// Applies an element of the list VRM.materialProperties of VRM 0.x, which belongs to the material of the same index:
/// MToon 0.x and the unlit shaders of UniVRM, converted to MToon 1.0 as https://github.com/vrm-c/UniVRM does. Colours
/// there are gamma-encoded.
void applyVrm0Material(const nlohmann::json& properties, const Vrm0Queues& queues, const TextureOfIndex& textureOf,
                       MemberReader& members, Material& material);

}  // namespace lorica
