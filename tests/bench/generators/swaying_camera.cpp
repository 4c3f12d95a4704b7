#include "tests/bench/generators/swaying_camera.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lorica::bench {

Mat3 swayAt(int frame) {
  const double seconds = frame / 30.0, degree = M_PI / 180.0;
  return (Eigen::AngleAxisd(6.0 * degree * std::sin(2.0 * M_PI * seconds / 4.0), Vec3::UnitZ()) *
          Eigen::AngleAxisd(7.0 * degree * std::sin(2.0 * M_PI * seconds / 6.0), Vec3::UnitY()))
      .toRotationMatrix();
}

void sway(const DepthCamera& camera, int frame, DepthFrame& depth) {
  const Mat3 stillFromSwaying = swayAt(frame).transpose();
  const std::vector<std::uint16_t> still = depth.depthMm;
  const double right = 0.5 * camera.width, down = 0.5 * camera.height;
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const Vec3 ray =
          stillFromSwaying * Vec3((column + 0.5 - right) / camera.focalX(), (down - row - 0.5) / camera.focalY(), -1.0);
      const int u = static_cast<int>(std::floor(right - camera.focalX() * ray.x() / ray.z()));
      const int v = static_cast<int>(std::floor(down + camera.focalY() * ray.y() / ray.z()));
      const bool inside = u >= 0 && u < camera.width && v >= 0 && v < camera.height;
      const double seen = inside ? still[static_cast<std::size_t>(v) * camera.width + u] : 0.0;
      depth.depthMm[static_cast<std::size_t>(row) * camera.width + column] =
          static_cast<std::uint16_t>(std::lround(seen / -ray.z()));
    }
  }
}

}  // namespace lorica::bench
