#pragma once

#include "geometry/math.h"

namespace lorica {

/// Between Unity's axes, in which the VMC protocol speaks, and ours: Unity is left-handed, with Y up, a body facing +Z
/// and its left at -X. The mirror image in X, so both ways are the same.
[[nodiscard]] inline Vec3 mirrorX(const Vec3& p) {
  return {-p.x(), p.y(), p.z()};
}
[[nodiscard]] inline Quat mirrorX(const Quat& q) {
  return {q.w(), q.x(), -q.y(), -q.z()};
}

}  // namespace lorica
