#pragma once

#include "collision/particles/particle_push_kernel.h"

namespace lorica {

/// Where a particle goes that was inside.
struct PushExit {
  Vec3f place;        ///< local, outside all hulls
  std::size_t hull;   ///< on whose surface it is, an index into hulls()
  std::size_t plane;  ///< the plane on which it is
};

/// A way out of the union of the hulls, near if not nearest. How: docs/PARTICLES.md.
/// @param start   local, inside a hull
/// @param inside  the one that it is deepest inside of
[[nodiscard]] PushExit findExit(const PushHulls& hulls, const PushGrid& grid, const Vec3f& start,
                                const PushDepth& inside);

}  // namespace lorica
