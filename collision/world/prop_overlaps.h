#pragma once

#include "collision/world/prop.h"

#include <cstddef>
#include <optional>
#include <span>

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

}  // namespace lorica
