#pragma once

#include "geometry/tri_mesh.h"
#include "viewer/prop_mesh.h"

namespace lorica {

/// A mesh to draw with extents 1 and bevel 0: round where its faces meet gently, sharp where they meet at more than 40
/// degrees. Three vertices a triangle. Triangles with numbers that are not finite are left out.
[[nodiscard]] PropMesh makeCreasedMesh(const TriMesh& mesh);

}  // namespace lorica
