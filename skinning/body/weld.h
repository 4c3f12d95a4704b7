#pragma once

#include "skinning/body/limbs.h"
#include "skinning/character.h"

#include <cstddef>
#include <span>
#include <vector>

namespace lorica {

/// A character's surface with one vertex per position, and counts of what changed.
struct Welded {
  TriMesh mesh;
  std::vector<std::vector<Influence>> influences;  ///< one list per vertex, joints ascending, weights summing to 1
  std::size_t weldedVertices = 0;
  std::size_t mixedVertices = 0;     ///< positions where welded vertices had different weights; their mean is used
  std::size_t droppedTriangles = 0;  ///< degenerate after welding
  std::size_t unusedVertices = 0;    ///< that no triangle uses
};

/// Merges vertices within a millionth of the mesh's diagonal of each other. The first of them keeps its position; order
/// is kept. Weights are averaged, so that seams whose sides differ slightly are closed. Two limbs that touch are not
/// welded together.
[[nodiscard]] Welded weld(const Character& character, const Limbs& limbs);

/// The mean of several lists of influences, joints ascending.
/// @param shares  one per list, summing to 1
[[nodiscard]] std::vector<Influence> blended(std::span<const std::vector<Influence>* const> lists,
                                             std::span<const double> shares);

}  // namespace lorica
