#pragma once

#include "skinning/body/limbs.h"
#include "skinning/character.h"

#include <cstddef>
#include <span>
#include <vector>

namespace lorica {

/// A character's surface with one vertex at each place, and what that took.
struct Welded {
  TriMesh mesh;
  std::vector<std::vector<Influence>> influences;  ///< one list a vertex, joints ascending, weights summing to 1
  std::size_t weldedVertices = 0;
  std::size_t mixedVertices = 0;     ///< places where the welded ones had other weights: these are the mean
  std::size_t droppedTriangles = 0;  ///< that lost a corner
  std::size_t unusedVertices = 0;    ///< that no triangle uses
};

/// Makes one vertex of those that lie within a millionth of the mesh's diagonal of each other. The first of them stays
/// where it is; order is kept. Its weights are the mean of theirs, so that a seam whose sides differ a little closes.
/// Two limbs that touch are not welded together.
[[nodiscard]] Welded weld(const Character& character, const Limbs& limbs);

/// Of triangles with the same three corners, whichever way they face, keeps the first: drawn from both sides, they
/// enclose nothing together.
/// @return how many were dropped
std::size_t dropDuplicates(std::vector<Triangle>& triangles);

/// The mean of several lists of influences, joints ascending.
/// @param shares  one a list, summing to 1
[[nodiscard]] std::vector<Influence> blended(std::span<const std::vector<Influence>* const> lists,
                                             std::span<const double> shares);

}  // namespace lorica
