#pragma once

#include "collision/live/live_part.h"
#include "collision/particles/neighbour_lists.h"
#include "collision/particles/particle_bodies.h"
#include "collision/particles/particle_grid.h"
#include "collision/particles/particle_obstacle.h"
#include "geometry/math.h"
#include "geometry/result.h"
#include "geometry/threads.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

inline constexpr std::size_t kParticlesAtOnce = 1024;

[[nodiscard]] inline Vec3f vectorOf(const ParticleRow& row) {
  return {row.x, row.y, row.z};
}
[[nodiscard]] inline ParticleRow rowOf(const Vec3f& vector, float w = 0.0f) {
  return {vector.x(), vector.y(), vector.z(), w};
}

/// @param what  of the settings of particles, for the sentence
[[nodiscard]] Result<void> checkAboveZero(std::string_view what, double value);

/// What sand and water have in common: particles in the order of a grid, their neighbours, and the avatar as an
/// obstacle. Internal to the particle simulations. Memory for all particles is allocated at once.
struct ParticleSet {
  /// @param radius  min distance of centres from the parts, the floor and the walls [m]
  ParticleSet(std::size_t capacity, const ParticleRoom& room, double radius, int maxNeighbours);

  /// Adds particles up to the capacity, skipping non-finite positions.
  /// @param motion  of each, in the simulation's own unit
  /// @return how many were added, at the end
  std::size_t add(std::span<const Vec3f> given, const Vec3f& motion, const Vec3f& velocity);

  /// A frame is divided into equal substeps. The body is applied in every second substep and in the last.
  struct Substeps {
    int count = 1;
    float seconds = 0.0f;  ///< of each
    static constexpr int kPerPush = 2;
    [[nodiscard]] bool pushes(int substep) const { return (count - substep) % kPerPush == 1; }
  };
  Substeps beginFrame(std::span<const LivePart> parts, std::span<ParticleBody> rigid, double seconds,
                      double maxSubstepSeconds);

  /// Writes what the particles changed to the bodies. One whose centre is between the particles' walls is pushed no
  /// farther out of these.
  void endFrame(std::span<ParticleBody> bodies);

  /// Calls work(i) for each particle, on all threads.
  template <class Work>
  void forEach(const Work& work) const {
    parallelRanges(count, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work(i);
    });
  }
  /// Calls work(firstBlock, lastBlock) for ranges of blocks of the neighbour lists, on all threads.
  template <class Work>
  void forBlocks(const Work& work) const {
    parallelRanges((count + kParticleBlock - 1) / kParticleBlock, kParticlesAtOnce / kParticleBlock, work);
  }

  /// Sorts by positions, which go to x, y, z; the ids follow.
  /// @param take  called as take(i, before): particle i was at `before`; moves along what else belongs to a particle
  template <class Take>
  void sort(std::span<const ParticleRow> by, float cellSize, int rows, const Take& take) {
    grid.sort(by, cellSize, rows);
    const std::uint32_t* order = grid.order().data();
    forEach([&](std::size_t i) {
      const ParticleRow& to = by[order[i]];
      x[i] = to.x;
      y[i] = to.y;
      z[i] = to.z;
      nextId[i] = id[order[i]];
      take(i, order[i]);
    });
    std::swap(id, nextId);
  }

  enum class Parts : std::uint8_t { kAll, kMoving };
  /// Sets the flags of at least all particles within a margin of what the parts sweep in the frame.
  /// @param flags  one for each particle, in the order of the last sorting
  /// @return whether any was set
  bool markAround(Parts which, float margin, std::vector<std::uint8_t>& flags) const;

  /// Writes positions and velocities in the order of adding.
  /// @param motionSeconds  duration of a motion; 1 if motions are velocities [s]
  void publish(float motionSeconds);

  ParticleRoom room;
  std::size_t count = 0;
  // In the order of the last sorting, those of the next substep, and working memory.
  std::vector<ParticleRow> position, motion, nextPosition, nextMotion;
  std::vector<std::uint32_t> id, nextId;
  std::vector<float> x, y, z;  // positions for the neighbour search
  std::vector<std::uint8_t> nearBody;
  ParticleGrid grid;
  NeighbourLists lists;
  ParticleObstacle body;
  ParticleBodies rigid;
  std::vector<Vec3f> candidates;  // positions of particles that the body may touch
  std::vector<std::uint32_t> candidateOf;
  std::vector<Vec3f> positions, velocities;  // by id
};

/// Sand or water, moved frame by frame.
class ParticleSimulation {
 public:
  virtual ~ParticleSimulation() = default;

  /// Adds particles up to the capacity.
  /// @param positions  world [m]; non-finite ones are skipped
  /// @return how many were added
  virtual std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity) = 0;

  /// Moves the particles from the last frame to this one; the parts move from their previous to their present pose.
  /// @param seconds  above 0
  /// @param bodies   that they meet; see ParticleBody
  virtual void step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) = 0;

  [[nodiscard]] std::size_t size() const { return set_.count; }  ///< number of particles so far
  /// In the order in which they were added, world [m].
  [[nodiscard]] std::span<const Vec3f> positions() const { return std::span(set_.positions).first(set_.count); }
  /// In the same order [m/s].
  [[nodiscard]] std::span<const Vec3f> velocities() const { return std::span(set_.velocities).first(set_.count); }

 protected:
  explicit ParticleSimulation(ParticleSet set) : set_(std::move(set)) {}
  ParticleSimulation(ParticleSimulation&&) = default;
  ParticleSimulation& operator=(ParticleSimulation&&) = default;

  ParticleSet set_;
};

}  // namespace lorica
