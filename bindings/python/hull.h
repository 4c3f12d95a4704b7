#pragma once

#include "geometry/convex_hull.h"

#include <pybind11/pybind11.h>

#include <memory>
#include <span>

namespace lorica {

/// A hull of something that lives as long as one of its hulls does: parts of a mesh, or a frame.
struct HullView {
  std::shared_ptr<const ConvexHull> hull;
};

/// A list of views. @param owner  of the hulls
[[nodiscard]] pybind11::list hullList(std::span<const ConvexHull> hulls, const std::shared_ptr<const void>& owner);

/// Character, Body, Live, Player, Frame, Contact, play().
void addCharacters(pybind11::module_& module);

}  // namespace lorica
