#pragma once

#include "geometry/tri_mesh.h"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace lorica {

using Vec2 = Eigen::Vector2d;

/// A directed edge between two vertices of a cap's border; the cap lies to its left.
using CapEdge = std::array<int, 2>;

/// Triangulates the plane region that closed loops of directed edges bound: any number of loops, holes, loops that
/// touch in a vertex. No vertex is added or left out and every border edge is the side of exactly one triangle, so the
/// cut part stays closed whatever the loops look like; on loops that cross themselves the triangles may overlap.
/// @param vertices  positions in the plane
/// @param edges     as many edges leave a vertex as arrive at it
[[nodiscard]] std::vector<Triangle> triangulateCap(std::span<const Vec2> vertices, std::span<const CapEdge> edges);

}  // namespace lorica
