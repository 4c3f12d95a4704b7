#include "viewer/renderer/picture_area.h"

#include <algorithm>
#include <cmath>

namespace lorica {

ViewAxes axesOf(const Camera& camera) {
  ViewAxes axes;
  const Vec3 along = camera.target - camera.eye;
  axes.forward = along.norm() > 1e-9 ? Vec3(along.normalized()) : Vec3(0, 0, -1);
  const Vec3 right = axes.forward.cross(camera.up);
  axes.right = right.norm() > 1e-6 ? Vec3(right.normalized()) : Vec3::UnitX();
  axes.up = axes.right.cross(axes.forward);
  return axes;
}

Vec3 directionAt(double azimuth, double elevation) {
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

std::array<Vec3, 8> cornersOf(const Aabb& box) {
  std::array<Vec3, 8> corners;
  for (int c = 0; c < 8; ++c) {
    corners[c] = Vec3((c & 1) != 0 ? box.max.x() : box.min.x(), (c & 2) != 0 ? box.max.y() : box.min.y(),
                      (c & 4) != 0 ? box.max.z() : box.min.z());
  }
  return corners;
}

double distanceToSee(std::span<const Vec3> points, const Camera& camera, const PictureArea& area, double aspect) {
  const ViewAxes axes = axesOf(camera);
  const double high = area.half.y() * std::tan(0.5 * camera.verticalFov);
  const double wide = area.half.x() * std::tan(0.5 * camera.verticalFov) * aspect;
  double distance = 0.0;
  for (const Vec3& point : points) {
    const Vec3 from = point - camera.target;
    const double depth = std::max(std::abs(from.dot(axes.right)) / wide, std::abs(from.dot(axes.up)) / high);
    distance = std::max(distance, depth - from.dot(axes.forward));
  }
  return distance;
}

}  // namespace lorica
