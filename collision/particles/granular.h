#pragma once

#include "collision/particles/particle_set.h"
#include "collision/particles/substep_kernel.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Sand: how much, and how it behaves.
struct GranularSettings {
  std::size_t capacity = 200'000;       ///< max number of grains
  double radius = 0.01;                 ///< of a grain [m]
  double friction = 0.4;                ///< Coulomb's coefficient, among grains, with the floor and the body
  Vec3 gravity{0.0, -9.81, 0.0};        ///< [m/s^2]
  double density = 2600.0;              ///< of a grain [kg/m^3]
  bool floor = true;                    ///< at y = 0
  std::optional<Aabb> walls;            ///< the grains stay within its x and z range; y is ignored
  double substepSeconds = 1.0 / 240.0;  ///< max substep; a frame is divided into equal substeps
};

/// Dry grains of one size, with contacts and friction among each other: position-based dynamics. The avatar's parts
/// push them. For the method and how it differs from real sand, see docs/PARTICLES.md.
///
/// After a step no grain is deeper than 1 mm in a part, below the floor or beyond a wall. None is faster than a
/// diameter in a substep (4.8 m/s with the default settings). Grains at rest cost little. The same bits for any number
/// of threads and on every instruction set. Stepping does not allocate after the first frame with a body. Internal to
/// Particles.
class Granular final : public ParticleSimulation {
 public:
  /// Empty; memory for the capacity is taken now.
  /// @return the sand, or which setting is out of range (kInvalidArgument)
  [[nodiscard]] static Result<Granular> create(const GranularSettings& settings);

  /// Positions are those of centres; ideally grains do not overlap.
  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity = Vec3::Zero()) override;
  void step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies = {}) override;
  /// Grains that were not at rest in the last substep.
  [[nodiscard]] std::size_t awakeCount() const;

 private:
  explicit Granular(const GranularSettings& wanted);
  void sort(float seconds);
  void findNeighbours(const ParticleRow& fall);
  void stepContacts(float seconds);
  void touchBodies(float seconds);
  void pushOut(float seconds);
  void rouse(float seconds);

  // Motions of the set are displacements in a substep [m]; for w, see GrainPass.
  GranularSettings settings_;
  std::vector<ParticleRow> goal_, nextGoal_;
  float diameter_;
  float motionSeconds_;  // of the substeps that the motions belong to
  std::vector<std::uint8_t> asleep_, woken_;
  bool anySleeps_ = false;
  double mass_;  // of a grain [kg]
};

}  // namespace lorica
