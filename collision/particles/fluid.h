#pragma once

#include "collision/live/live_part.h"
#include "collision/particles/fluid_kernel.h"
#include "collision/particles/neighbour_lists.h"
#include "collision/particles/particle_grid.h"
#include "collision/particles/particle_obstacle.h"
#include "geometry/math.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

struct FluidSettings {
  std::size_t capacity = 100'000;       ///< max number of particles
  double spacing = 0.02;                ///< of particles at rest: each has the volume of a cube of this side [m]
  double viscosity = 0.1;               ///< 0 to 1: how much neighbours' velocities are equalised in a substep
  Vec3 gravity{0.0, -9.81, 0.0};        ///< [m/s^2]
  bool floor = true;                    ///< at y = 0
  std::optional<Aabb> walls;            ///< the fluid stays within its x and z range; y is ignored
  double substepSeconds = 1.0 / 120.0;  ///< max substep; a frame is divided into equal substeps
  int iterations = 2;                   ///< density iterations per substep
};

/// A fluid that keeps its volume: position-based fluid (Macklin and Mueller 2013) with viscosity. The avatar's parts
/// push it. For the method and how it differs from the paper, see docs/PARTICLES.md.
///
/// After a step no particle is deeper than 1 mm in a part, below the floor or beyond a wall. None is faster than 12 m/s
/// with the default settings: five spacings in a substep. The same bits for any number of threads and on every
/// instruction set. Stepping does not allocate after the first frame with a body.
class Fluid {
 public:
  explicit Fluid(const FluidSettings& settings);

  /// Adds particles up to the capacity; ideally they are one spacing apart.
  /// @param positions  world [m]; non-finite ones are skipped
  /// @return how many were added
  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity = Vec3::Zero());

  /// Moves the fluid from the last frame to this one; the parts move from their previous to their present pose.
  /// @param seconds  above 0
  void step(std::span<const LivePart> parts, double seconds);

  [[nodiscard]] std::size_t size() const { return count_; }
  /// In the order in which they were added [m].
  [[nodiscard]] std::span<const Vec3f> positions() const { return {positions_.data(), count_}; }
  [[nodiscard]] std::span<const Vec3f> velocities() const { return {velocities_.data(), count_}; }
  [[nodiscard]] const FluidSettings& settings() const { return settings_; }

 private:
  void predict(float seconds, bool sorts);
  void keepVolume(float seconds);
  void pushOut(float seconds);

  FluidSettings settings_;
  ParticleRoom room_;
  float spacing_;
  FluidKernels kernels_;
  std::size_t count_ = 0;
  // In the order of the last sorting, and working memory.
  std::vector<ParticleRow> position_, before_, motion_, nextPosition_, nextMotion_;  // motions in m/s
  std::vector<std::uint32_t> id_, nextId_;
  std::vector<float> x_, y_, z_;
  std::vector<float> pressure_, nextPressure_;
  float pressureSeconds_ = 0.0f;    // of the substep that the pressures belong to
  std::vector<std::uint8_t> none_;  // excludes no particle from the lists
  std::vector<std::uint8_t> nearBody_;
  ParticleGrid grid_;
  NeighbourLists lists_;
  ParticleObstacle body_;
  std::vector<Vec3f> candidates_;
  std::vector<std::uint32_t> candidateOf_;
  std::vector<Vec3f> positions_, velocities_;  // by id
};

}  // namespace lorica
