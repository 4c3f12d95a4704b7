#include "geometry/math.h"

#include <Eigen/Eigenvalues>

namespace lorica {

Vec3 Aabb::center() const {
  return 0.5 * (min + max);
}

double Aabb::diagonal() const {
  return empty() ? 0.0 : (max - min).norm();
}

Aabb boundsOf(std::span<const Vec3> points) {
  Aabb box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

Quat rotationBetween(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to);
}

Eigen::Quaternionf rotationBetween(const Vec3f& from, const Vec3f& to) {
  return Eigen::Quaternionf::FromTwoVectors(from, to);
}

SymmetricAxes symmetricAxes(const Mat3& matrix) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace lorica
