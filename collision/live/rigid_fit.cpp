#include "collision/live/rigid_fit.h"

#include "collision/live/rotation_kernel.h"
#include "geometry/result.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {

namespace {

constexpr double kSettled = 1e-9;  // size of a step after which the next one, its square, is below rounding
constexpr int kSteps = 30;

/// By singular value decomposition, for any covariance.
Mat3 fitThin(const Mat3& covariance, const Mat3& previous) {
  // A pull towards the previous rotation, a billion times weaker than the points, decides only what they leave
  // undetermined. After a frame of bones that were not numbers there is none.
  const Mat3 towards = previous.allFinite() ? previous : Mat3(Mat3::Identity());
  const double pull = std::max(1e-9 * covariance.norm(), std::numeric_limits<double>::min());
  const Eigen::JacobiSVD<Mat3> svd(covariance + pull * towards, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  // A mirrored fit is turned into the best proper one by flipping the axis in which the points vary least.
  if (u.determinant() * svd.matrixV().determinant() < 0.0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

/// For a distant start: polar decomposition by Newton's method, with scaling (Higham 1986).
Mat3 fitFar(const Mat3& covariance, const Mat3& previous) {
  const double norm = covariance.norm();
  if (!(covariance.determinant() > kThinDeterminant * norm * norm * norm)) return fitThin(covariance, previous);
  Mat3 r = covariance / norm;
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

}  // namespace

void fitRotations(std::span<const Mat3> covariances, std::span<Mat3> rotations) {
  LORICA_CHECK(covariances.size() == rotations.size(), "there must be one rotation per covariance");
  constexpr std::size_t kAtOnce = MatrixBlock::kMatrices;
  for (std::size_t first = 0; first < covariances.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, covariances.size() - first);
    MatrixBlock from;
    MatrixBlock fits;
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t e = 0; e < 9; ++e) {
        const Eigen::Index row = e / 3;
        const Eigen::Index column = e % 3;
        from.entry[e][k] = covariances[first + k](row, column);
        fits.entry[e][k] = rotations[first + k](row, column);
      }
    }
    const std::uint32_t found = fitNearby(from, fits);
    for (std::size_t k = 0; k < count; ++k) {
      Mat3& rotation = rotations[first + k];
      if ((found >> k & 1U) == 0) {
        rotation = fitFar(covariances[first + k], rotation);
        continue;
      }
      for (std::size_t e = 0; e < 9; ++e) {
        rotation(e / 3, e % 3) = fits.entry[e][k];
      }
    }
  }
}

Mat3 fitRotation(const Mat3& covariance, const Mat3& previous) {
  Mat3 rotation = previous;
  fitRotations({&covariance, 1}, {&rotation, 1});
  return rotation;
}

Vec3 centroidOf(std::span<const Vec3> points) {
  if (points.empty()) return Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / points.size();
}

Isometry3 fitRigidMotion(std::span<const Vec3> from, std::span<const Vec3> to, const Mat3& previous) {
  LORICA_CHECK(from.size() == to.size() && !to.empty(), "a rigid fit needs two non-empty point sets of the same size");

  // The best R maximises trace(R^T C). The centroid of `to` cancels because `from` has mean zero, but subtracting it
  // keeps the precision of a small body far from the origin.
  const Vec3 center = centroidOf(to);
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) covariance += (to[i] - center) * from[i].transpose();

  Isometry3 motion = Isometry3::Identity();
  motion.linear() = fitRotation(covariance, previous);
  motion.translation() = center;
  return motion;
}

}  // namespace lorica
