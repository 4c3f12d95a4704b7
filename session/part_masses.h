#pragma once

#include "acd/decomposition.h"
#include "skinning/character.h"

#include <vector>

namespace lorica {

/// Density of a body, for the mass of its parts [kg/m^3]: that of water.
inline constexpr double kBodyDensity = 1000.0;

/// Mass of each part of a character: its own volume in the bind pose, without those of its neighbours [kg].
[[nodiscard]] std::vector<double> partMasses(const Decomposition& decomposition, const Character& character);

}  // namespace lorica
