#include "geometry/rigid_distance.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace lorica {

double rigidDistance(std::span<const Vec3> a, std::span<const Vec3> b) {
  Mat3 s = Mat3::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    s += a[i] * b[i].transpose();
    squares += a[i].squaredNorm() + b[i].squaredNorm();
  }
  Mat4 gain = Mat4::Zero();  // the solver reads only the lower triangle
  gain(0, 0) = s(0, 0) + s(1, 1) + s(2, 2);
  gain(1, 1) = s(0, 0) - s(1, 1) - s(2, 2);
  gain(2, 2) = s(1, 1) - s(2, 2) - s(0, 0);
  gain(3, 3) = s(2, 2) - s(0, 0) - s(1, 1);
  gain(1, 0) = s(1, 2) - s(2, 1);
  gain(2, 0) = s(2, 0) - s(0, 2);
  gain(3, 0) = s(0, 1) - s(1, 0);
  gain(2, 1) = s(0, 1) + s(1, 0);
  gain(3, 1) = s(2, 0) + s(0, 2);
  gain(3, 2) = s(1, 2) + s(2, 1);
  const Eigen::SelfAdjointEigenSolver<Mat4> solver(gain, Eigen::EigenvaluesOnly);
  const double meanSq = (squares - 2.0 * solver.eigenvalues()(3)) / a.size();
  // Round to a micrometre: mirrored poses differ only by rounding errors, which must not decide their order.
  return std::round(std::sqrt(std::max(0.0, meanSq)) * 1e6) * 1e-6;
}

}  // namespace lorica
