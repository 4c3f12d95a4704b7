#pragma once

#include <algorithm>

namespace lorica {

/// Faster parts jumped rather than moved: the fastest human kicks and punches stay below 20 m/s.
inline constexpr double kTeleportSpeed = 25.0;

/// Fastest strike of a part of some trust [m/s]: 0.5 without trust, rising linearly to kTeleportSpeed with full trust.
[[nodiscard]] inline double strikeLimit(double trust) {
  constexpr double kDistrustedSpeed = 0.5;
  return kDistrustedSpeed + std::max(trust, 0.0) * (kTeleportSpeed - kDistrustedSpeed);
}

}  // namespace lorica
