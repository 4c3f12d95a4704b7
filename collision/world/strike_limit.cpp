#include "collision/world/strike_limit.h"

#include <algorithm>

namespace lorica {

double strikeLimit(double trust) {
  constexpr double kDistrustedSpeed = 0.5;
  return kDistrustedSpeed + std::max(trust, 0.0) * (kTeleportSpeed - kDistrustedSpeed);
}

double closingSpeed(const LivePart& first, const LivePart& second, const Vec3& point, const Vec3& direction,
                    double seconds) {
  const Vec3 firstVelocity = velocityAt(first, point, seconds);
  const Vec3 secondVelocity = velocityAt(second, point, seconds);
  if (std::max(firstVelocity.norm(), secondVelocity.norm()) > kTeleportSpeed) return 0.0;
  const double closing = (firstVelocity - secondVelocity).dot(direction);
  return std::clamp(closing, 0.0, strikeLimit(std::min(first.trust, second.trust)));
}

}  // namespace lorica
