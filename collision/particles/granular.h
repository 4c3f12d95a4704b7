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
/// of threads and on every instruction set. Stepping does not allocate after the first frame with a body.
class Granular {
 public:
  /// Empty; memory for the capacity is taken now.
  /// @return the sand, or which setting is out of range (kInvalidArgument)
  [[nodiscard]] static Result<Granular> create(const GranularSettings& settings);
  ~Granular();
  Granular(Granular&&) noexcept;
  Granular& operator=(Granular&&) noexcept;

  /// Adds grains up to the capacity; ideally they do not overlap.
  /// @param positions  centres, world [m]; non-finite ones are skipped
  /// @return how many were added
  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity = Vec3::Zero());

  /// Moves the grains from the last frame to this one; the parts move from their previous to their present pose.
  /// @param seconds  above 0
  /// @param bodies   that they meet; see ParticleBody
  void step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies = {});

  [[nodiscard]] std::size_t size() const { return positions().size(); }  ///< number of grains so far
  /// Centres, in the order in which they were added [m].
  [[nodiscard]] std::span<const Vec3f> positions() const;
  /// In the same order [m/s].
  [[nodiscard]] std::span<const Vec3f> velocities() const;
  [[nodiscard]] const GranularSettings& settings() const;  ///< what it was made with
  /// Grains that were not at rest in the last substep.
  [[nodiscard]] std::size_t awakeCount() const;

 private:
  struct State;
  explicit Granular(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lorica
