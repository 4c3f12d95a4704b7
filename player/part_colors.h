#pragma once

#include "acd/decomposition.h"
#include "skinning/character.h"

#include <vector>

namespace lorica {

/// The number of each part's colour, see partColor(): that of the bone that moves most of it, so that left and right
/// tell apart and a body looks the same however it was decomposed. No two parts have the same number.
[[nodiscard]] std::vector<PartIndex> colorsOfParts(const Decomposition& decomposition, const Character& character);

}  // namespace lorica
