#pragma once

#include "collision/particle_push_hulls.h"

namespace lorica {

/// Where a particle goes that was inside.
struct PushExit {
  Vec3f place;        ///< local, outside all hulls
  std::size_t hull;   ///< on whose surface it is, an index into hulls()
  std::size_t plane;  ///< the plane on which it is
};

/// A way out of the union of the hulls, near if not nearest. How: docs/PARTICLES.md.
/// @param start  local, inside a hull
/// @param hull   the one that it is inside of
/// @param plane  nearest to it of that hull's
[[nodiscard]] PushExit findExit(const PushHulls& hulls, const Vec3f& start, std::size_t hull, std::size_t plane);

}  // namespace lorica
