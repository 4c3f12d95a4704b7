#pragma once

#include "skinning/character.h"

#include <span>

namespace lorica {

/// Where each joint takes the bind pose: worldFromJoint * jointFromModel. Allocates nothing.
/// @param worldFromJoint  jointCount transforms
/// @param worldFromModel  jointCount transforms, written; may be the same memory
void computeWorldFromModel(const Character& character, std::span<const Affine3> worldFromJoint,
                           std::span<Affine3> worldFromModel);

/// Linear blend skinning of the whole mesh. Allocates nothing.
/// @param worldFromModel  jointCount transforms, see computeWorldFromModel()
/// @param posed           vertexCount positions, written [m]
void skinLinearBlend(const Character& character, std::span<const Affine3> worldFromModel, std::span<Vec3> posed);

}  // namespace lorica
