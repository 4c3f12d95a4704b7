#pragma once

#include "geometry/tri_mesh.h"

#include <span>

namespace lorica {

/// Mass properties of a solid of density 1.
struct MassProperties {
  double volume = 0.0;          ///< [m^3]
  Vec3 center = Vec3::Zero();   ///< centre of mass [m]
  Mat3 inertia = Mat3::Zero();  ///< about the centre of mass, along the coordinate axes [m^5]
};

/// Computes the mass properties of the solid inside closed surfaces, as exact integrals over tetrahedra. Triangles must
/// be counter-clockwise seen from outside. If the volume is 0, centre and inertia are 0.
[[nodiscard]] MassProperties massProperties(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Principal axes and moments: inertia = axes * moments.asDiagonal() * axes.transpose().
struct PrincipalInertia {
  Mat3 axes = Mat3::Identity();  ///< columns, right-handed
  Vec3 moments = Vec3::Zero();   ///< ascending [m^5]
};
/// Diagonalizes an inertia tensor; only its lower triangle is read.
[[nodiscard]] PrincipalInertia principalInertia(const Mat3& inertia);

}  // namespace lorica
