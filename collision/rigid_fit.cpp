#include "collision/rigid_fit.h"

#include "geometry/result.h"

#include <Eigen/SVD>

#include <algorithm>
#include <limits>

namespace lorica {

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

  // A pull towards the previous rotation, a billion times weaker than the points, decides only what they leave open.
  const double pull = std::max(1e-9 * covariance.norm(), std::numeric_limits<double>::min());
  covariance += pull * previous;

  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  // A mirrored fit is turned into the best proper one by flipping the axis in which the points vary least.
  if (u.determinant() * svd.matrixV().determinant() < 0.0) u.col(2) = -u.col(2);

  Isometry3 motion = Isometry3::Identity();
  motion.linear() = u * svd.matrixV().transpose();
  motion.translation() = center;
  return motion;
}

}  // namespace lorica
