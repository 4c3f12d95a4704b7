#pragma once

#include "collision/live/lifted_point.h"

#include <span>
#include <vector>

namespace lorica {

/// The vertices of a character that no part contains, listed for the part whose hull is to cover them in addition to
/// its own points.
///
/// Such vertices belong to the visible surface if a closed body was made from an open surface, see
/// skinning/body/closed_body.h. For each part, consider the hull of the points that are moved most by the same bone as
/// the vertex; the vertex is attached to the part from whose hull it protrudes least in the bind pose. These points
/// move the vertex along in any pose, so it hardly enlarges the part's hull. If no part follows that bone, the vertex
/// is attached to the part with the nearest surface.
/// @param lifted  of all points of the decomposition
/// @return one list per part, ascending; each vertex is in exactly one
[[nodiscard]] std::vector<std::vector<PointIndex>> attachedVerticesOf(const Decomposition& decomposition,
                                                                      std::span<const LiftedPoint> lifted);

}  // namespace lorica
