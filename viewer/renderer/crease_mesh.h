#pragma once

#include "geometry/tri_mesh.h"
#include "viewer/renderer/prop_mesh.h"

namespace lorica {

/// A mesh to draw with extents 1 and bevel 0. Edges between faces at more than 40 degrees are sharp, other edges have
/// smooth normals. Three vertices per triangle. Triangles with non-finite coordinates are omitted.
[[nodiscard]] PropMesh makeCreasedMesh(const TriMesh& mesh);

}  // namespace lorica
