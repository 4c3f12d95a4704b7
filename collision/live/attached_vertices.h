#pragma once

#include "collision/live/lifted_point.h"

#include <span>
#include <vector>

namespace lorica {

/// The vertices of a character that no part has, for each part those that its hull is to hold besides its own points.
///
/// Such vertices belong to what people see where a body was made of an open surface, see skinning/body/closed_body.h.
/// Each goes to the part where it sticks out least, in the bind pose, of the hull of those points that the same bone
/// moves most: these take it along in any pose, so it hardly makes the part's hull larger. Where no part follows that
/// bone, it goes to the part with the nearest surface.
/// @param lifted  of all points of the decomposition
/// @return one list a part, ascending; each vertex is in one
[[nodiscard]] std::vector<std::vector<PointIndex>> passengersOf(const Decomposition& decomposition,
                                                                std::span<const LiftedPoint> lifted);

}  // namespace lorica
