#pragma once

#include "collision/live/moving_hull.h"

#include <span>
#include <string>
#include <vector>

namespace lorica::test {

/// Points rounded to ticks about their mean, as MovingHull takes them.
[[nodiscard]] std::vector<PointRow> aboutTheirMean(std::span<const Vec3> points, double ticksPerUnit);

/// Looks at a hull as if it had fallen from the sky, by brute force in 128-bit integers: faces closed, each turned away
/// from the origin, no point above any of them; vertices those of the faces; volume that of convexHull().
/// @return empty, or the first thing that is not so
[[nodiscard]] std::string whatIsWrong(const MovingHull& hull, std::span<const PointRow> points);

}  // namespace lorica::test
