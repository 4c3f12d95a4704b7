#pragma once

#include "collision/particles/particle_push.h"
#include "collision/particles/particle_push_grid.h"
#include "collision/particles/particle_push_hulls.h"
#include "geometry/math.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace lorica {

/// What ParticlePush does with its particles, with vector instructions. The same on every instruction set.

/// A hull that a point is inside of, and the nearest of its planes that may lead out.
struct PushDepth {
  float height = 0.0F;  ///< of the point above that plane [m]: below 0 inside, 0 where it is inside of no hull
  std::uint32_t hull = 0;
  std::uint32_t plane = 0;
};

/// That which it is deepest inside of.
/// @param p  local
[[nodiscard]] PushDepth deepestAt(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p);

/// All that it is inside of, by index; as many as there is room for.
/// @return how many
std::size_t depthsAt(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p, std::span<PushDepth> depths);

/// Planes of a hull that may lead out, the nearest to a point first, each looking another way than those before it.
/// @param p      local
/// @param faces  as many as there is room for
/// @return how many; none of a hull with very many planes
std::size_t waysOut(const PushHulls& hulls, std::uint32_t hull, const Vec3f& p, std::span<PushDepth> faces);

/// Where a ray leaves a hull.
struct PushLeave {
  float length = 0.0F;  ///< infinite where it does not
  std::uint32_t plane = 0;
};

/// @param p          local, inside the hull
/// @param direction  of length 1
/// @return where the ray is a margin above a plane, the nearest
[[nodiscard]] PushLeave leaveHull(const PushHulls& hulls, std::uint32_t hull, const Vec3f& p, const Vec3f& direction);

/// Moves the particles of one chunk that are inside.
/// @param xyz      `count` particles, world
/// @param scratch  room for `count` and 16 more
/// @param first    added to the indices of the particles
/// @return how many were touched
std::size_t pushParticles(const PushHulls& hulls, const PushGrid& grid, float* xyz, std::size_t count,
                          std::uint32_t first, std::uint32_t* scratch, ParticleTouch* touches);

}  // namespace lorica
