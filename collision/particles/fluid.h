#pragma once

#include "collision/live/live_part.h"
#include "collision/particles/particle_bodies.h"
#include "geometry/math.h"
#include "geometry/result.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace lorica {

/// Water: how much, and how it behaves.
struct FluidSettings {
  std::size_t capacity = 100'000;       ///< max number of particles
  double spacing = 0.02;                ///< of particles at rest: each has the volume of a cube of this side [m]
  double viscosity = 0.1;               ///< 0 to 1: how much neighbours' velocities are equalised in a substep
  Vec3 gravity{0.0, -9.81, 0.0};        ///< [m/s^2]
  bool floor = true;                    ///< at y = 0
  std::optional<Aabb> walls;            ///< the fluid stays within its x and z range; y is ignored
  double substepSeconds = 1.0 / 120.0;  ///< max substep; a frame is divided into equal substeps
  int iterations = 2;                   ///< density iterations per substep
  double density = 1000.0;              ///< at rest [kg/m^3]
};

/// A fluid that keeps its volume: position-based fluid (Macklin and Mueller 2013) with viscosity. The avatar's parts
/// push it. For the method and how it differs from the paper, see docs/PARTICLES.md.
///
/// After a step no particle is deeper than 1 mm in a part, below the floor or beyond a wall. None is faster than 12 m/s
/// with the default settings: five spacings in a substep. The same bits for any number of threads and on every
/// instruction set. Stepping does not allocate after the first frame with a body.
class Fluid {
 public:
  /// Empty; memory for the capacity is taken now.
  /// @return the fluid, or which setting is out of range (kInvalidArgument)
  [[nodiscard]] static Result<Fluid> create(const FluidSettings& settings);
  ~Fluid();
  Fluid(Fluid&&) noexcept;
  Fluid& operator=(Fluid&&) noexcept;

  /// Adds particles up to the capacity; ideally they are one spacing apart.
  /// @param positions  world [m]; non-finite ones are skipped
  /// @return how many were added
  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity = Vec3::Zero());

  /// Moves the fluid from the last frame to this one; the parts move from their previous to their present pose.
  /// @param seconds  above 0
  /// @param bodies   that they meet; see ParticleBody
  void step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies = {});

  [[nodiscard]] std::size_t size() const { return positions().size(); }  ///< number of particles so far
  /// In the order in which they were added [m].
  [[nodiscard]] std::span<const Vec3f> positions() const;
  /// In the same order [m/s].
  [[nodiscard]] std::span<const Vec3f> velocities() const;
  [[nodiscard]] const FluidSettings& settings() const;  ///< what it was made with

 private:
  struct State;
  explicit Fluid(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lorica
