#pragma once

#include "geometry/math.h"

#include <optional>
#include <span>

namespace lorica {

/// The half-space normal . x >= offset, with a unit normal.
struct HalfSpace {
  Vec3 normal = Vec3::Zero();
  double offset = 0.0;
};

/// Minimizes objective . x over the intersection of the half-spaces and the box |x|, |y|, |z| <= `reach`. Returns
/// nothing if the intersection is empty. Incremental algorithm after Seidel 1991, in the given order: for a few tens of
/// half-spaces. Violations below 1e-11 are ignored, so positions should be of the order of 1. Internal: not installed.
[[nodiscard]] std::optional<Vec3> minimizeLinear(const Vec3& objective, std::span<const HalfSpace> halfSpaces,
                                                 double reach);

}  // namespace lorica
