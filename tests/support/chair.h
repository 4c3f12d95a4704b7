#pragma once

#include "geometry/math.h"

#include <vector>

namespace lorica::test {

/// A chair of six boxes, 0.45 m to the seat, for a person who sits at a position and faces +Z.
/// @param middle  of the seat, on the floor [m]
[[nodiscard]] inline std::vector<Aabb> chairAt(const Vec3& middle) {
  constexpr double kHalf = 0.22;       // of the seat
  constexpr double kThickness = 0.04;  // of all parts
  constexpr double kSeat = 0.45;
  constexpr double kBack = 0.90;
  std::vector<Aabb> boxes;
  boxes.reserve(6);
  const auto add = [&](const Vec3& min, const Vec3& max) { boxes.push_back({middle + min, middle + max}); };
  add({-kHalf, kSeat - kThickness, -kHalf}, {kHalf, kSeat, kHalf});
  add({-kHalf, kSeat, -kHalf - kThickness}, {kHalf, kBack, -kHalf});
  for (const double x : {-kHalf, kHalf - kThickness}) {
    for (const double z : {-kHalf, kHalf - kThickness}) {
      add({x, 0.0, z}, {x + kThickness, kSeat - kThickness, z + kThickness});
    }
  }
  return boxes;
}

}  // namespace lorica::test
