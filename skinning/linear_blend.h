#pragma once

#include "skinning/character.h"

#include <span>

namespace lorica {

/// Linear blend skinning of the whole mesh. Allocates nothing.
/// @param worldFromJoint  jointCount transforms
/// @param skinMatrices    jointCount scratch transforms, written: worldFromJoint * jointFromModel
/// @param posed           vertexCount positions, written [m]
void skinLinearBlend(const Character& character, std::span<const Affine3> worldFromJoint,
                     std::span<Affine3> skinMatrices, std::span<Vec3> posed);

}  // namespace lorica
