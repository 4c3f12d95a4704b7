#include "geometry/mass_properties.h"

namespace lorica {

MassProperties massProperties(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  MassProperties result;
  if (triangles.empty()) return result;
  // Tetrahedra from one corner of the surface, so that numbers stay small far from the origin.
  const Vec3& apex = vertices[triangles[0][0]];
  double sixVolume = 0.0;
  Vec3 first = Vec3::Zero();   // 24 x the integral of position
  Mat3 second = Mat3::Zero();  // 120 x the integral of position * position^T
  for (const Triangle& t : triangles) {
    const Vec3 a = vertices[t[0]] - apex;
    const Vec3 b = vertices[t[1]] - apex;
    const Vec3 c = vertices[t[2]] - apex;
    const double det = a.dot(b.cross(c));
    const Vec3 sum = a + b + c;
    sixVolume += det;
    first += det * sum;
    second += det * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  if (sixVolume == 0.0) return result;
  result.volume = sixVolume / 6.0;
  const Vec3 center = first / (4.0 * sixVolume);
  result.center = apex + center;
  const Mat3 spread = second / 120.0 - result.volume * center * center.transpose();
  result.inertia = spread.trace() * Mat3::Identity() - spread;
  return result;
}

PrincipalInertia principalInertia(const Mat3& inertia) {
  const SymmetricAxes solver = symmetricAxes(inertia);
  PrincipalInertia result;
  result.axes = solver.vectors;
  result.moments = solver.values;
  if (result.axes.determinant() < 0.0) result.axes.col(2) *= -1.0;
  return result;
}

}  // namespace lorica
