#pragma once

#include "collision/particles/particle_push_kernel.h"

namespace lorica {

/// The new position of a particle that was inside.
struct PushExit {
  Vec3f position;     ///< local, outside all hulls
  std::size_t hull;   ///< hull on whose surface it is, an index into hulls()
  std::size_t plane;  ///< the plane on which it is
};

/// A way out of the union of the hulls, not necessarily the nearest. Method: docs/PARTICLES.md.
/// @param start   local, inside a hull
/// @param inside  the hull in which it is deepest
[[nodiscard]] PushExit findExit(const PushHulls& hulls, const PushGrid& grid, const Vec3f& start,
                                const PushDepth& inside);

}  // namespace lorica
