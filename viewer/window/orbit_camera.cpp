#include "viewer/window/orbit_camera.h"

#include "viewer/renderer/picture_area.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr double kHighest = 1.54;   // just below 90 degrees, where the up direction would be undefined [rad]
constexpr double kLowest = 0.05;    // of the eye above the floor [m]
constexpr double kNearest = 0.2;    // [m]
constexpr double kFarthest = 60.0;  // [m]

}  // namespace

OrbitCamera::OrbitCamera(const Camera& start) : start_(start) {
  reset();
}

void OrbitCamera::reset() {
  const Vec3 offset = start_.eye - start_.target;
  target_ = start_.target;
  distance_ = std::clamp(offset.norm(), kNearest, kFarthest);
  azimuth_ = std::atan2(offset.x(), offset.z());
  elevation_ = std::clamp(std::asin(std::clamp(offset.y() / distance_, -1.0, 1.0)), -kHighest, kHighest);
}

void OrbitCamera::turn(double right, double up) {
  azimuth_ = std::remainder(azimuth_ + right, 2.0 * EIGEN_PI);
  elevation_ = std::clamp(elevation_ + up, -kHighest, kHighest);
  stayAboveFloor();
}

void OrbitCamera::pan(double right, double up) {
  const ViewAxes axes = axesOf(camera());
  const double pictureHeight = 2.0 * distance_ * std::tan(0.5 * start_.verticalFov);
  target_ += pictureHeight * (right * axes.right + up * axes.up);
  stayAboveFloor();
}

void OrbitCamera::zoom(double factor) {
  distance_ = std::clamp(distance_ * factor, kNearest, kFarthest);
  stayAboveFloor();
}

void OrbitCamera::carry(const Vec3& by) {
  target_ += by;
  start_.target += by;
  start_.eye += by;
}

void OrbitCamera::aimAt(const Vec3& point) {
  target_ = point;
  stayAboveFloor();
}

void OrbitCamera::lookFrom(double azimuth, double elevation) {
  azimuth_ = azimuth;
  elevation_ = std::clamp(elevation, -kHighest, kHighest);
  stayAboveFloor();
}

void OrbitCamera::stayAboveFloor() {
  target_.y() = std::max(target_.y(), 0.0);
  const double lowest = std::asin(std::clamp((kLowest - target_.y()) / distance_, -1.0, 1.0));
  elevation_ = std::max(elevation_, std::min(lowest, kHighest));
}

Camera OrbitCamera::camera() const {
  Camera camera = start_;
  camera.target = target_;
  camera.eye = target_ + distance_ * directionAt(azimuth_, elevation_);
  return camera;
}

}  // namespace lorica
