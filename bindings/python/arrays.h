#pragma once

#include "geometry/arrays/mesh_sequence.h"
#include "geometry/convex_hull.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <span>

namespace lorica {

/// The mesh in two arrays, (n, 3) numbers, or (k, n, 3) of k frames, and (m, 3) integers of any type and strides.
/// @throws ValueError  with a sentence about shape, type, first number that is not finite, or index out of range
[[nodiscard]] MeshSequence meshFrom(const pybind11::object& vertices, const pybind11::object& faces);

/// Transforms in an array of (count, 4, 4) numbers.
/// @throws ValueError  with a sentence
[[nodiscard]] std::vector<Affine3> transformsFrom(const pybind11::object& matrices, std::size_t count);

/// Points in an array of (n, 3) numbers, or one point in an array of 3.
/// @throws ValueError  with a sentence about shape or type
[[nodiscard]] std::vector<Vec3> pointsFrom(const pybind11::object& points);

/// Read-only arrays over memory that belongs to `owner`, which they keep alive.
[[nodiscard]] pybind11::array view(std::span<const Vec3> points, pybind11::handle owner);
[[nodiscard]] pybind11::array view(std::span<const Triangle> triangles, pybind11::handle owner);
[[nodiscard]] pybind11::array view(std::span<const Affine3> transforms, pybind11::handle owner);

/// A hull of something that lives as long as one of its hulls does: parts of a mesh, or a frame.
struct HullView {
  std::shared_ptr<const ConvexHull> hull;
};

/// A list of views. @param owner  of the hulls
[[nodiscard]] pybind11::list hullList(std::span<const ConvexHull> hulls, const std::shared_ptr<const void>& owner);

/// Character, Body, Live, Player, Frame, Contact, play().
void addCharacters(pybind11::module_& module);

}  // namespace lorica
