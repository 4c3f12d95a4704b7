#pragma once

#include "collision/live/live_part.h"

#include <algorithm>

namespace lorica {

/// Faster parts jumped rather than moved: the fastest human kicks and punches stay below 20 m/s.
inline constexpr double kTeleportSpeed = 25.0;

/// Fastest strike of a part of some trust [m/s]: 0.5 without trust, rising linearly to kTeleportSpeed with full trust.
[[nodiscard]] inline double strikeLimit(double trust) {
  constexpr double kDistrustedSpeed = 0.5;
  return kDistrustedSpeed + std::max(trust, 0.0) * (kTeleportSpeed - kDistrustedSpeed);
}

/// How fast two parts approach each other at a point, by their rigid motion [m/s]: 0 while they rest or move apart, and
/// if one jumped; at most the limit of the less trusted one.
/// @param point      world [m]
/// @param direction  from the first part to the second, unit
/// @param seconds    since the last frame, above 0
[[nodiscard]] inline double closingSpeed(const LivePart& first, const LivePart& second, const Vec3& point,
                                         const Vec3& direction, double seconds) {
  const Vec3 firstVelocity = velocityAt(first, point, seconds);
  const Vec3 secondVelocity = velocityAt(second, point, seconds);
  if (std::max(firstVelocity.norm(), secondVelocity.norm()) > kTeleportSpeed) return 0.0;
  const double closing = (firstVelocity - secondVelocity).dot(direction);
  return std::clamp(closing, 0.0, strikeLimit(std::min(first.trust, second.trust)));
}

}  // namespace lorica
