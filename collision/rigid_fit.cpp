#include "collision/rigid_fit.h"

#include "geometry/result.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {

namespace {

constexpr double kThin = 1e-4;     // of the norm cubed: below this determinant, points are nearly flat, or mirrored
constexpr double kSettled = 1e-9;  // change of a step after which the next one, its square, is below rounding
constexpr int kNearSteps = 5;
constexpr int kSteps = 30;

/// By singular values, for any covariance.
Mat3 fitThin(const Mat3& covariance, const Mat3& previous) {
  // A pull towards the previous rotation, a billion times weaker than the points, decides only what they leave open.
  const double pull = std::max(1e-9 * covariance.norm(), std::numeric_limits<double>::min());
  const Eigen::JacobiSVD<Mat3> svd(covariance + pull * previous, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  // A mirrored fit is turned into the best proper one by flipping the axis in which the points vary least.
  if (u.determinant() * svd.matrixV().determinant() < 0.0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

}  // namespace

Mat3 fitRotation(const Mat3& covariance, const Mat3& previous) {
  const double norm = covariance.norm();
  if (!(covariance.determinant() > kThin * norm * norm * norm)) return fitThin(covariance, previous);

  // From a rotation nearby a few Newton steps lead to the one that makes R^T covariance symmetric. That is the best one
  // if the product is positive definite too.
  const double tiny = kThin * norm;
  Mat3 r = 0.5 * previous * (3.0 * Mat3::Identity() - previous.transpose() * previous);  // drift of many frames undone
  for (int step = 0; step < kNearSteps; ++step) {
    const Mat3 a = r.transpose() * covariance;
    const Mat3 p = 0.5 * (a + a.transpose());
    const bool definite = p(0, 0) > tiny && p(0, 0) * p(1, 1) - p(0, 1) * p(0, 1) > tiny * tiny &&
                          p.determinant() > 0.5 * covariance.determinant();
    if (!definite) break;
    const Vec3 skew(a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1));
    const Vec3 turn = (p.trace() * Mat3::Identity() - p).inverse() * skew;
    r = r * Quat(2.0, turn.x(), turn.y(), turn.z()).normalized().toRotationMatrix();
    if (turn.norm() <= kSettled) return r;
  }

  // Else polar decomposition by Newton's method, with scaling (Higham 1986).
  r = covariance / norm;
  for (int step = 0; step < kSteps; ++step) {
    const Mat3 inverse = r.inverse().transpose();
    const double scale = std::sqrt(inverse.norm() / r.norm());
    const Mat3 next = 0.5 * (scale * r + inverse / scale);
    const double change = (next - r).norm();
    r = next;
    if (change <= kSettled) return r;
  }
  return fitThin(covariance, previous);
}

Vec3 centroidOf(std::span<const Vec3> points) {
  if (points.empty()) return Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

Isometry3 fitRigidMotion(std::span<const Vec3> from, std::span<const Vec3> to, const Mat3& previous) {
  CHECK(from.size() == to.size() && !to.empty(), "a rigid fit needs two point sets of the same size");

  // The best R maximises trace(R^T C). The centroid of `to` drops out because `from` has mean zero, but subtracting
  // it keeps the digits of a small body that is far from the origin.
  const Vec3 center = centroidOf(to);
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) covariance += (to[i] - center) * from[i].transpose();

  Isometry3 motion = Isometry3::Identity();
  motion.linear() = fitRotation(covariance, previous);
  motion.translation() = center;
  return motion;
}

}  // namespace lorica
