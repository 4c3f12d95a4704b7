#pragma once

#include "skinning/character.h"

#include <span>
#include <vector>

namespace lorica {

/// Appends a vertex and its influences to a character.
void appendVertex(Character& character, const Vec3& vertex, std::span<const Influence> influences);

/// A character with the same bones and without a mesh.
[[nodiscard]] Character bonesOf(const Character& character);

/// ClosedBody::character of a body that was built: the surface's vertices, then those that the character's triangles
/// use.
/// @param surface  closed
/// @param weights  one list for each of its vertices
[[nodiscard]] Character assembleBody(const Character& character, const TriMesh& surface,
                                     std::span<const std::vector<Influence>> weights);

}  // namespace lorica
