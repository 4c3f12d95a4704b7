#pragma once

#include "skinning/look/material.h"
#include "skinning/morphs/expressions.h"

#include <span>

namespace lorica {

/// Whether an expression changes colours or texture coordinates.
[[nodiscard]] bool changesMaterials(const Expressions& expressions);

/// The materials that a face shows: a colour, a scale or an offset is base + weight x (value - base), summed over all
/// expressions. Texture coordinates change for all textures of a material but its matcap. Does not allocate memory.
/// https://github.com/vrm-c/vrm-specification: VRMC_vrm-1.0/expressions.md
/// @param effective  weight of each expression, see effectiveWeights()
/// @param materials  of the avatar
/// @param shown      as many, written where an expression names the material; a copy of `materials` at first
void expressMaterials(const Expressions& expressions, std::span<const float> effective,
                      std::span<const Material> materials, std::span<Material> shown);

}  // namespace lorica
