#pragma once

#include "tests/bench/generators/motion_performance.h"

/// The choreographies of the shipped motions. The person faces +Z, towards the default camera.
namespace lorica::motion {

[[nodiscard]] Performance walk();
[[nodiscard]] Performance wave();
[[nodiscard]] Performance jumpingJacks();
[[nodiscard]] Performance squatAndReach();
[[nodiscard]] Performance punchAndKick();
[[nodiscard]] Performance turnAround();

// Usual positions of hands and elbows; arguments of reach() for a left arm.
inline const Vec3 kHang(0.065, -0.537, 0.055);
inline const Vec3 kHangPole(0.25, 0.0, -1.0);

/// A curve through keys whose values are degrees.
[[nodiscard]] inline Track inDegrees(std::vector<TrackKey> keys) {
  for (TrackKey& key : keys) key.value = degrees(key.value);
  return Track(std::move(keys));
}

/// Feet side by side, slightly turned out.
[[nodiscard]] inline Placement standing(Side side, double x = 0.0, double z = 0.0, double yaw = 0.0,
                                        double halfWidth = 0.095) {
  const double mirror = side == kLeft ? 1.0 : -1.0;
  const Vec3 aside = turned(yaw, 0.0, 0.0) * Vec3(mirror * halfWidth, 0.0, 0.0);
  return {x + aside.x(), z + aside.z(), yaw + mirror * degrees(9.0)};
}

}  // namespace lorica::motion
