#pragma once

#include "geometry/math.h"

#include <optional>
#include <span>

namespace lorica {

/// normal . x >= offset, with a unit normal.
struct HalfSpace {
  Vec3 normal = Vec3::Zero();
  double offset = 0.0;
};

/// The point of a box |x|, |y|, |z| <= `reach` that all half-spaces share with the least objective . x, or none if they
/// share no point. Incremental, after Seidel 1991, in the order given: for some tens of half-spaces. Violations below
/// 1e-11 count as none, so positions should be of the order of 1. Internal: not installed.
[[nodiscard]] std::optional<Vec3> minimizeLinear(const Vec3& objective, std::span<const HalfSpace> halfSpaces,
                                                 double reach);

}  // namespace lorica
