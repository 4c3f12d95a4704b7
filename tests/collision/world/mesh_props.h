#pragma once

#include "collision/world/prop.h"

#include <span>

namespace lorica::test {

/// A mesh prop of boxes, each a hull; the origin is moved to the centre of the bounding box.
[[nodiscard]] Prop propOfBoxes(std::span<const Aabb> boxes);
/// An L of three cubes, at (0, 0), (1, 0) and (0, 1) in units of the cube's side.
[[nodiscard]] Prop propOfLShape(double side);
/// A square frame of four bars about Y: hole of side `inner`, bars `width` wide and high.
[[nodiscard]] Prop propOfFrame(double inner, double width);

}  // namespace lorica::test
