#pragma once

#include "collision/live/live_part.h"
#include "geometry/math.h"
#include "geometry/result.h"

#include <cstdint>
#include <memory>
#include <span>

namespace lorica {

/// How particles are kept out of the hulls.
struct ParticlePushSettings {
  /// Min distance of particles from the hulls [m]: 0 for points, else the radius of a grain. Measured from the planes
  /// of the faces, so it is slightly larger at sharp edges.
  double radius = 0.0;
  int threads = 0;  ///< max number of threads; 0: as many as the machine has. The result does not depend on it.
};

/// What happened to a particle that was inside.
struct ParticleTouch {
  std::uint32_t particle;  ///< index into the positions
  std::uint32_t part;      ///< index into the parts: the one on whose surface it lies now
  float depth;             ///< how far it was moved [m]
  Vec3f normal;            ///< outward, of the surface on which it lies now
  Vec3f surfaceVelocity;   ///< of the part's material there [m/s], by its rigid motion; times LivePart::trust
};

/// Pushes the particles of your own simulation out of the live parts. See docs/PARTICLES.md.
///
///     push.prepare(body.parts(), seconds);                          // once per frame
///     for (const ParticleTouch& touch : push.push(positions)) {     // as often as your simulation needs
///       velocities[touch.particle] += velocityChange(touch, velocities[touch.particle], friction);
///     }
///
/// A particle inside the union of the hulls is moved to its surface, near its previous position. Afterwards none is
/// inside any hull by more than a few thousandths of a millimetre (for a body of human size). The same bits for any
/// number of threads and on every instruction set. Allocates only for more parts, faces or particles than ever before.
class ParticlePush {
 public:
  /// Without parts; nothing is pushed before they are set.
  /// @return it, or that the radius is below 0 (kInvalidArgument)
  [[nodiscard]] static Result<ParticlePush> create(const ParticlePushSettings& settings = {});
  ~ParticlePush();
  ParticlePush(ParticlePush&&) noexcept;
  ParticlePush& operator=(ParticlePush&&) noexcept;

  /// Takes the present state of the parts; keeps no reference. Parts without triangles (flat ones), with non-finite
  /// poses, or a thousand kilometres away push nothing.
  /// @param seconds  since the last call, above 0
  /// @param again    these are the parts of the last call, moved on by a fraction of a frame: reuses the information
  /// which faces lead into other parts. It only guides the search, and saves most of the time for hulls of many faces.
  void prepare(std::span<const LivePart> parts, double seconds, bool again = false);

  /// Moves the particles that are inside. Non-finite positions are left unchanged.
  /// @param positions  world [m]
  /// @return the particles that were moved, by ascending index; valid until the next call
  std::span<const ParticleTouch> push(std::span<Vec3f> positions);

 private:
  struct State;
  explicit ParticlePush(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Velocity change of a touched particle [m/s]: along the normal it becomes at least as fast as the surface, and
/// friction reduces its sliding by up to `friction` times that change.
/// @param velocity  before [m/s]
/// @param friction  Coulomb's coefficient; 0 slides freely
[[nodiscard]] Vec3f velocityChange(const ParticleTouch& touch, const Vec3f& velocity, float friction = 0.0F);

}  // namespace lorica
