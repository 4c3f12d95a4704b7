#pragma once

#include "geometry/tri_mesh.h"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace lorica {

using Vec2 = Eigen::Vector2d;

/// A directed edge between two vertices of a cap's border; the cap is on its left.
using CapEdge = std::array<int, 2>;

/// Triangulates the plane region bounded by closed loops of directed edges: any number of loops, holes, loops that
/// touch at a vertex. No vertex is added or left out, and every border edge is a side of exactly one triangle, so the
/// cut part is closed for any loops. If loops cross themselves, triangles may overlap.
/// @param vertices  positions in the plane
/// @param edges     equally many edges start and end at each vertex
[[nodiscard]] std::vector<Triangle> triangulateCap(std::span<const Vec2> vertices, std::span<const CapEdge> edges);

}  // namespace lorica
