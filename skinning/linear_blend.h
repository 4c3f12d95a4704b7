#pragma once

#include "skinning/character.h"

#include <span>

namespace lorica {

/// The skinning matrix of each joint: worldFromJoint * jointFromModel. Does not allocate memory.
/// @param worldFromJoint  jointCount transforms
/// @param worldFromModel  jointCount transforms, written; may be worldFromJoint itself
void computeWorldFromModel(const Character& character, std::span<const Affine3> worldFromJoint,
                           std::span<Affine3> worldFromModel);

/// Linear blend skinning of the whole mesh, deformed by its shapes. Does not allocate memory.
/// @param worldFromModel  jointCount transforms, see computeWorldFromModel()
/// @param posed           vertexCount positions, written [m]
void skinLinearBlend(const Character& character, std::span<const Affine3> worldFromModel, std::span<Vec3> posed);
/// The same of one vertex [m].
[[nodiscard]] Vec3 skinLinearBlend(const Character& character, std::span<const Affine3> worldFromModel,
                                   VertexIndex vertex);

}  // namespace lorica
