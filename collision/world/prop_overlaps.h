#pragma once

#include "collision/live/live_part.h"
#include "collision/world/prop.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Two props of a list that start inside each other: the centre of mass of one is in both.
struct PropOverlap {
  std::size_t inner = 0, outer = 0;  ///< indices
};

/// The first pair of props that start inside each other; pairs of static bodies may.
[[nodiscard]] std::optional<PropOverlap> findPropInside(std::span<const Prop> props);

/// The first static body that contains a point.
[[nodiscard]] std::optional<std::size_t> findStaticAround(std::span<const Prop> props, const Vec3& point);

/// Number of pairs of props whose bounding boxes overlap; pairs of static bodies do not count.
[[nodiscard]] std::size_t countNearPairs(std::span<const Prop> props);

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
