#pragma once

#include "collision/live/live_part.h"

namespace lorica {

/// Faster parts jumped rather than moved: the fastest human kicks and punches stay below 20 m/s.
inline constexpr double kTeleportSpeed = 25.0;

/// Fastest strike of a part of some trust [m/s]: 0.5 without trust, rising linearly to kTeleportSpeed with full trust.
[[nodiscard]] double strikeLimit(double trust);

/// How fast two parts approach each other at a point, by their rigid motion [m/s]: 0 while they rest or move apart, and
/// if one jumped; at most the limit of the less trusted one.
/// @param point      world [m]
/// @param direction  from the first part to the second, unit
/// @param seconds    since the last frame, above 0
[[nodiscard]] double closingSpeed(const LivePart& first, const LivePart& second, const Vec3& point,
                                  const Vec3& direction, double seconds);

}  // namespace lorica
