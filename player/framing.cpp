#include "player/framing.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr double kNear = 4.0;      // of what a scene is about, from the target [m]
constexpr double kHighest = 2.0;   // what is above waits to fall [m]
constexpr double kFarthest = 1.5;  // the camera moves back at most to this many times its distance
constexpr double kAcross = 1.05;   // half the free width of a picture per half of its height: 16:9 without panels
constexpr double kUpward = 0.85;   // of half its height, above the transport

}  // namespace

Camera framing(const Camera& start, const World& world) {
  const Vec3 back = start.eye - start.target;
  const Vec3 forward = -back.normalized();
  const Vec3 right = forward.cross(Vec3::UnitY()).normalized();
  const Vec3 up = right.cross(forward);
  const double half = std::tan(0.5 * start.verticalFov);
  double distance = back.norm();
  for (const Prop& prop : world.props()) {
    const Vec3 from = prop.worldFromProp.translation() - start.target;
    const bool part = prop.mass > 0.0 && from.norm() <= kNear && prop.worldFromProp.translation().y() <= kHighest;
    if (!part) continue;
    const double reach = prop.halfExtents.norm();
    const double needed = std::max((std::abs(from.dot(right)) + reach) / (half * kAcross),
                                   (std::abs(from.dot(up)) + reach) / (half * kUpward));
    distance = std::max(distance, needed - from.dot(forward));
  }
  Camera camera = start;
  camera.eye = start.target + std::min(distance / back.norm(), kFarthest) * back;
  return camera;
}

}  // namespace lorica
