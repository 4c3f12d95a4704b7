#include "player/framing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

constexpr double kBeside = 35.0 * std::numbers::pi / 180.0, kAbove = 0.17;  // of the usual view [rad]
constexpr double kDistance = 2.6;                                           // in sizes of the avatars
constexpr double kNear = 4.0;      // of what a scene is about, from the target [m]
constexpr double kHighest = 2.0;   // what is above waits to fall [m]
constexpr double kFarthest = 1.5;  // the camera moves back at most to this many times its distance
constexpr double kAcross = 1.05;   // half the free width of a picture per half of its height: 16:9 without panels
constexpr double kUpward = 0.85;   // of half its height, above the transport

}  // namespace

Vec3 usualDirection(double facing) {
  return directionAt(facing - kBeside, kAbove);
}

Camera windowCamera(const Aabb& avatars, double facing, const World& world) {
  Camera camera;
  camera.target = avatars.center();
  const double size = std::max(avatars.max.y() - avatars.min.y(), 0.5 * avatars.diagonal()), usual = kDistance * size;
  const Vec3 direction = usualDirection(facing);
  camera.eye = camera.target + usual * direction;
  const ViewAxes axes = axesOf(camera);
  const double half = std::tan(0.5 * camera.verticalFov);
  double distance = usual;
  for (const Prop& prop : world.props()) {
    const Vec3 from = prop.worldFromProp.translation() - camera.target;
    const bool part = prop.mass > 0.0 && from.norm() <= kNear && prop.worldFromProp.translation().y() <= kHighest;
    if (!part) continue;
    const double reach = prop.halfExtents.norm();
    const double needed = std::max((std::abs(from.dot(axes.right)) + reach) / (half * kAcross),
                                   (std::abs(from.dot(axes.up)) + reach) / (half * kUpward));
    distance = std::max(distance, needed - from.dot(axes.forward));
  }
  camera.eye = camera.target + std::min(distance, kFarthest * usual) * direction;
  return camera;
}

}  // namespace lorica
