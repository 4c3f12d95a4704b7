#pragma once

#include "collision/hulls/mesh_walls.h"
#include "geometry/convex_hull.h"

#include <utility>
#include <vector>

namespace lorica::test {

/// A sheet of revolution about Y. A point of the profile (radius, y) on the axis closes the sheet there.
[[nodiscard]] TriMesh revolved(const std::vector<std::pair<double, double>>& profile, int segments);

/// A bowl of 24 flat sides, a sheet: its bottom is at y = 0 and has a radius of 0.6, its rim at 0.7 one of 1.
[[nodiscard]] TriMesh makeBowl();

/// A box around the origin without a lid, as a sheet of ten triangles; `size` is half of its side.
[[nodiscard]] TriMesh openBox(double size);

/// Its thin walls.
[[nodiscard]] WallBody wallsOf(const TriMesh& mesh, const CharacterOptions& options = {});

/// Of the parts of a closed mesh, with the default preset.
[[nodiscard]] std::vector<ConvexHull> hullsOf(const TriMesh& mesh, int parts);

}  // namespace lorica::test
