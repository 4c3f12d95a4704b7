#pragma once

#include "geometry/tri_mesh.h"

#include <span>

namespace lorica {

/// Of a solid of density 1.
struct MassProperties {
  double volume = 0.0;          ///< [m^3]
  Vec3 center = Vec3::Zero();   ///< of mass [m]
  Mat3 inertia = Mat3::Zero();  ///< about the centre, along the axes of the coordinates [m^5]
};

/// Of the solid inside closed surfaces, whose triangles run counter-clockwise seen from outside; their exact integrals,
/// tetrahedron by tetrahedron. A volume of 0 leaves centre and inertia at 0.
[[nodiscard]] MassProperties massProperties(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Inertia along its own axes: inertia = axes * moments.asDiagonal() * axes.transpose().
struct PrincipalInertia {
  Mat3 axes = Mat3::Identity();  ///< columns, right-handed
  Vec3 moments = Vec3::Zero();   ///< ascending [m^5]
};
[[nodiscard]] PrincipalInertia principalInertia(const Mat3& inertia);

}  // namespace lorica
