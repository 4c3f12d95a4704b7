#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"

#include <span>
#include <vector>

namespace lorica {

/// Assigns vertices that no part contains to parts whose hulls are to contain them: each to the part whose hull is
/// nearest. Vertices inside a hull, or less than 1e-9 of the mesh's diagonal outside, are not assigned.
/// @param vertices  of the mesh, in one pose
/// @param held      vertices of no part
/// @return one list for each part, ascending
[[nodiscard]] std::vector<std::vector<PointIndex>> assignHeldVertices(const Decomposition& decomposition,
                                                                      std::span<const Vec3> vertices,
                                                                      std::span<const VertexIndex> held);

/// The decomposition with such vertices among its parts' points, so that hulls, volumes and errors include them. It has
/// the same triangles; it is not for files, which get a HullCover instead.
[[nodiscard]] Decomposition withHeldVertices(Decomposition decomposition,
                                             std::span<const std::vector<PointIndex>> verticesOfPart);

/// A cover with all points of such a decomposition that can be on a hull, not displaced.
[[nodiscard]] HullCover coverWithHeldVertices(const Decomposition& decomposition);

}  // namespace lorica
