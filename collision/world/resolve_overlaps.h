#pragma once

#include "collision/live/live_part.h"
#include "collision/world/prop.h"

#include <span>
#include <vector>

namespace lorica {

/// Finds displacements that move all props out of the avatar.
///
/// Props that touch each other, such as a stack, move together. Props on the floor move outwards, away from the
/// avatar's centre; props in the air move up. Each moves in steps of 5 cm until it is 1 cm clear of all parts and other
/// props, by at most 20 m; if that does not help, it stays. Static bodies and props that are clear from the start stay
/// too. A prop is represented by its bounding box, or by a ball.
/// @param parts  of the avatar; flat hulls are ignored
/// @return displacement of each prop [m]
[[nodiscard]] std::vector<Vec3> resolveOverlaps(std::span<const LivePart> parts, std::span<const Prop> props);

}  // namespace lorica
