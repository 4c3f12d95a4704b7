#pragma once

#include "geometry/tri_mesh.h"

#include <span>

namespace lorica {

/// Returns a frame that turns with the mesh: the rows of a rotation matrix. Everything that depends on axes is computed
/// in it, so that parts do not depend on how the mesh lies.
///
/// The axes are normals shared by much of the surface (a table's faces); where there are none, principal axes of
/// inertia. For a mesh whose faces lie along the coordinate axes the frame is a permutation of these, exactly.
/// @param points  positions in one keyframe [m]; the triangles form a closed surface
[[nodiscard]] Mat3 frameOf(std::span<const Vec3> points, std::span<const Triangle> triangles);

}  // namespace lorica
