#pragma once

#include "collision/live/live_part.h"
#include "collision/world/prop.h"

#include <span>
#include <vector>

namespace lorica {

/// Where props have to go so that none is inside the avatar.
///
/// Props that touch each other, such as a stack, go together. Those that stand on the floor go outwards, away from the
/// avatar's middle; those in the air go up. Each goes in steps of 5 cm until it is 1 cm clear of all parts and of the
/// other props, 20 m at most; where that does not help it stays. What is clear from the start stays too, and furniture.
/// A prop counts as the box around it, or as a ball.
/// @param parts  of the avatar; flat ones are in nobody's way
/// @return for each prop how far it goes [m]
[[nodiscard]] std::vector<Vec3> roomFor(std::span<const LivePart> parts, std::span<const Prop> props);

}  // namespace lorica
