#pragma once

#include "collision/live/moving_hull.h"

#include <span>
#include <string>
#include <vector>

namespace lorica::test {

/// Points rounded to ticks about their mean, as MovingHull takes them.
[[nodiscard]] std::vector<PointRow> aboutTheirMean(std::span<const Vec3> points, double ticksPerUnit);

/// Checks a hull independently of its history, by brute force in 128-bit integers: faces closed, each facing away from
/// the origin, no point above any of them; vertices those of the faces; volume that of convexHull().
/// @return empty, or the first defect found
[[nodiscard]] std::string whatIsWrong(const MovingHull& hull, std::span<const PointRow> points);

}  // namespace lorica::test
