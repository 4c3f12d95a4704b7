#pragma once

#include "acd/cut.h"

#include <optional>
#include <span>

namespace lorica {

/// Returns a plane between two convex hulls, given by their vertices; none if they touch or overlap. The first hull is
/// above the plane. The gap across it is at least half of the distance between the hulls.
///
/// Walks towards the nearest points of the hulls: Gilbert, Johnson, Keerthi 1988.
[[nodiscard]] std::optional<Plane> separatingPlane(std::span<const Vec3> above, std::span<const Vec3> below);

}  // namespace lorica
