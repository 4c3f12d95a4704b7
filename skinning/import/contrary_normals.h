#pragma once

#include "geometry/tri_mesh.h"

#include <span>

namespace lorica {

enum class ContraryNormals { kNone, kNormalsReplaced, kTrianglesTurned };

/// Repairs a smooth surface on which more than a tenth of the area faces away from all its normals, which would be
/// drawn with dark stripes. Where neighbouring triangles agree about the outside, the normals are replaced by the mean
/// of the triangles around each position, weighted by area, but for edges of more than 60 degrees. Where they do not,
/// the triangles are turned to agree with the normals, if that leaves fewer edges at which neighbours disagree.
/// @param triangles  of one surface, over all vertices
/// @param normals    one per vertex; those of other vertices are not changed
ContraryNormals mendContraryNormals(std::span<const Vec3> vertices, std::span<Triangle> triangles,
                                    std::span<Vec3f> normals);

}  // namespace lorica
