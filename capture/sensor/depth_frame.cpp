#include "capture/sensor/depth_frame.h"

#include <cmath>

namespace lorica {

double DepthCamera::focalX() const {
  return 0.5 * width / std::tan(0.5 * horizontalFov);
}
double DepthCamera::focalY() const {
  return 0.5 * height / std::tan(0.5 * verticalFov);
}

Vec3 DepthCamera::positionOf(double column, double row, double depth) const {
  const double x = (column + 0.5 - 0.5 * width) / focalX();
  const double y = (row + 0.5 - 0.5 * height) / focalY();
  return {x * depth, -y * depth, -depth};
}

Eigen::Vector2d DepthCamera::imagePointOf(const Vec3& position) const {
  const double depth = -position.z();
  return {0.5 * width + focalX() * position.x() / depth, 0.5 * height - focalY() * position.y() / depth};
}

}  // namespace lorica
