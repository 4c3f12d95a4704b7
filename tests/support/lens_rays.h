#pragma once

#include "capture/sensor/depth_lens.h"
#include "geometry/math.h"

namespace lorica::test {

/// Where OpenCV's model puts a ray, from the centre of the first pixel [pixels].
inline Eigen::Vector2d imageOf(const DepthLens& lens, double x, double y) {
  const auto& d = lens.distortion;
  const double s = x * x + y * y;
  const double bent =
      (1 + d[0] * s + d[1] * s * s + d[4] * s * s * s) / (1 + d[5] * s + d[6] * s * s + d[7] * s * s * s);
  return {lens.focalX * (x * bent + 2 * d[2] * x * y + d[3] * (s + 2 * x * x)) + lens.centreX,
          lens.focalY * (y * bent + d[2] * (s + 2 * y * y) + 2 * d[3] * x * y) + lens.centreY};
}

/// The ray of a pixel, by Newton's method with numeric derivatives.
inline Eigen::Vector2d rayOfPixel(const DepthLens& lens, double column, double row) {
  Eigen::Vector2d ray((column - lens.centreX) / lens.focalX, (row - lens.centreY) / lens.focalY);
  for (int step = 0; step < 30; ++step) {
    const Eigen::Vector2d at = imageOf(lens, ray.x(), ray.y());
    constexpr double kSmall = 1e-6;
    Eigen::Matrix2d slope;
    slope.col(0) = (imageOf(lens, ray.x() + kSmall, ray.y()) - at) / kSmall;
    slope.col(1) = (imageOf(lens, ray.x(), ray.y() + kSmall) - at) / kSmall;
    const Eigen::Vector2d change = slope.inverse() * (Eigen::Vector2d(column, row) - at);
    ray += change.norm() > 0.1 ? Eigen::Vector2d(0.1 * change.normalized()) : change;
  }
  return ray;
}

}  // namespace lorica::test
