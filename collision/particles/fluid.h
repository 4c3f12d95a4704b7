#pragma once

#include "collision/particles/particle_set.h"
#include "collision/particles/standing_water.h"
#include "collision/particles/substep_kernel.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

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
/// instruction set. Stepping does not allocate after the first frame with a body. Internal to Particles.
class Fluid final : public ParticleSimulation {
 public:
  /// Empty; memory for the capacity is taken now.
  /// @return the fluid, or which setting is out of range (kInvalidArgument)
  [[nodiscard]] static Result<Fluid> create(const FluidSettings& settings);

  /// Ideally particles are one spacing apart.
  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity = Vec3::Zero()) override;
  void step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies = {}) override;

 private:
  explicit Fluid(const FluidSettings& wanted);
  void holdUp();
  void predict(float seconds, bool sorts);
  void keepVolume(float seconds);
  void findMotions(float seconds);
  void meetBodies();
  void pressBodies(float seconds);
  void touchBodies(float seconds);
  void pushOut(float seconds);
  /// That any particle can be from where it was sorted [m].
  [[nodiscard]] float farthest() const;

  // Motions of the set are velocities [m/s].
  FluidSettings settings_;
  float spacing_;
  FluidKernels kernels_;
  std::vector<ParticleRow> before_;  // positions in the previous substep
  std::vector<float> pressure_, nextPressure_;
  std::vector<float> lasting_, nextLasting_;  // its mean over time
  float pressureSeconds_ = 0.0f;              // of the substep that the pressures belong to
  StandingWater standing_;
  std::vector<StandingWater::Solid> solids_;
  std::vector<ParticleRow> lift_, nextLift_;  // see StandingWater
  double mass_;                               // of a particle [kg]
  std::vector<ParticleRow> bodyWalls_;        // see BodyTerms; all 0 where no body is near
  std::vector<float> bodyYielding_;
  std::span<const ParticleBodies::Contact> contacts_;
};

}  // namespace lorica
