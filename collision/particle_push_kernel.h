#pragma once

#include "collision/particle_push.h"
#include "collision/particle_push_grid.h"
#include "collision/particle_push_hulls.h"
#include "geometry/math.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace lorica {

/// What ParticlePush does with its particles, with vector instructions. The same on every instruction set.

/// The hull that a point is deepest inside of, and the nearest of its planes.
struct PushDepth {
  float height = 0.0F;  ///< of the point above that plane [m]: below 0 inside, 0 where it is inside of no hull
  std::uint32_t hull = 0;
  std::uint32_t plane = 0;
};

/// @param p  local
[[nodiscard]] PushDepth deepestAt(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p);

/// Moves the particles of one chunk that are inside.
/// @param xyz      `count` particles, world
/// @param scratch  room for `count` and 16 more
/// @param first    added to the indices of the particles
/// @return how many were touched
std::size_t pushParticles(const PushHulls& hulls, const PushGrid& grid, float* xyz, std::size_t count,
                          std::uint32_t first, std::uint32_t* scratch, ParticleTouch* touches);

}  // namespace lorica
