#pragma once

#include "collision/particles/particle_push.h"
#include "collision/particles/particle_push_grid.h"
#include "collision/particles/particle_push_hulls.h"
#include "geometry/math.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Vectorised operations of ParticlePush on its particles. The same on every instruction set.

/// A hull that contains a point, and the nearest of its planes that may lead out.
struct PushDepth {
  float height = 0.0F;  ///< of the point above that plane [m]: below 0 inside, 0 if it is inside no hull
  std::uint32_t hull = 0;
  std::uint32_t plane = 0;
};

/// The hull in which the point is deepest.
/// @param p  local
[[nodiscard]] PushDepth deepestAt(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p);

/// All hulls that contain the point, by index; as many as `depths` has space for.
/// @return how many
std::size_t depthsAt(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p, std::span<PushDepth> depths);

/// Planes of a hull that may lead out, the nearest to a point first, each with a normal that differs from those before
/// it.
/// @param p        local
/// @param longest  farther ones are of no interest [m]
/// @param faces    receives as many as it has space for
/// @return how many; none for a hull with very many planes
std::size_t waysOut(const PushHulls& hulls, std::uint32_t hull, const Vec3f& p, float longest,
                    std::span<PushDepth> faces);

/// Where a ray leaves a hull.
struct PushLeave {
  float length = 0.0F;  ///< infinite if it does not
  std::uint32_t plane = 0;
};

/// @param p          local, inside the hull
/// @param direction  of length 1
/// @return the nearest point of the ray that is a margin above a plane
[[nodiscard]] PushLeave leaveHull(const PushHulls& hulls, std::uint32_t hull, const Vec3f& p, const Vec3f& direction);

/// Whether a point is inside a hull.
/// @param p  local
[[nodiscard]] bool isInsideAny(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p);

/// Whether a point is more than `by` above one of a hull's planes.
/// @param p  local
[[nodiscard]] bool isAbove(const PushHulls& hulls, std::uint32_t hull, const Vec3f& p, float by);

/// The new position of a particle that was inside.
struct PushExit {
  Vec3f position;     ///< local, outside all hulls
  std::size_t hull;   ///< hull on whose surface it is, an index into hulls()
  std::size_t plane;  ///< the plane on which it is
};

/// A way out of the union of the hulls, not necessarily the nearest. Method: docs/PARTICLES.md. In
/// particle_push_exit.cpp.
/// @param start   local, inside a hull
/// @param inside  the hull in which it is deepest
[[nodiscard]] PushExit findExit(const PushHulls& hulls, const PushGrid& grid, const Vec3f& start,
                                const PushDepth& inside);

/// Working memory of a thread for a chunk of particles.
struct PushScratch {
  /// A particle, in the order of cells.
  struct Row {
    float x, y, z;  ///< local
    std::uint32_t listed;
  };
  std::vector<std::uint32_t> listed, cell;  ///< particles near a hull, and their cells; then their places in the result
  std::vector<std::uint32_t> starts;        ///< in `rows`, for each list of the grid
  std::vector<Row> rows;
  std::vector<PushDepth> depths;  ///< of the listed ones
  void reserveRows(std::size_t particles, std::size_t lists);
};

/// Moves the particles of one chunk that are inside.
/// @param xyz      `count` particles, world
/// @param first    added to the indices of the particles
/// @param touches  by ascending index
/// @return how many were touched
std::size_t pushParticles(const PushHulls& hulls, const PushGrid& grid, float* xyz, std::size_t count,
                          std::uint32_t first, PushScratch& scratch, ParticleTouch* touches);

}  // namespace lorica
