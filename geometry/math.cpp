#include "geometry/math.h"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace lorica {
namespace {

/// Eigen's FromTwoVectors to the bit, but for opposite vectors: for these alone it compiles a singular value
/// decomposition, which takes ten seconds.
template <class Number, class Vector = Eigen::Matrix<Number, 3, 1>>
Eigen::Quaternion<Number> rotationOf(const Vector& from, const Vector& to) {
  const Vector a = from.normalized();
  const Vector b = to.normalized();
  const Number cosine = b.dot(a);
  if (cosine < Number(-1) + Eigen::NumTraits<Number>::dummy_precision()) {
    const Number squared = (Number(1) + std::max(cosine, Number(-1))) * Number(0.5);
    const Vector axis = a.unitOrthogonal() * std::sqrt(Number(1) - squared);
    return {std::sqrt(squared), axis.x(), axis.y(), axis.z()};
  }
  const Number twice = std::sqrt((Number(1) + cosine) * Number(2));
  const Vector axis = a.cross(b) * (Number(1) / twice);
  return {twice * Number(0.5), axis.x(), axis.y(), axis.z()};
}

}  // namespace

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
  return rotationOf<double>(from, to);
}

Eigen::Quaternionf rotationBetween(const Vec3f& from, const Vec3f& to) {
  return rotationOf<float>(from, to);
}

SymmetricAxes symmetricAxes(const Mat3& matrix) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace lorica
