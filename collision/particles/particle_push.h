#pragma once

#include "collision/live/live_part.h"
#include "geometry/math.h"

#include <cstdint>
#include <memory>
#include <span>

namespace lorica {

struct ParticlePushSettings {
  /// How far particles are kept from the hulls [m]: 0 for points, else the radius of a grain. Measured from the planes
  /// of the faces, so a little more beside sharp edges.
  double radius = 0.0;
  int threads = 0;  ///< at most so many; 0: as many as the machine has. The result does not depend on it.
};

/// What happened to a particle that was inside.
struct ParticleTouch {
  std::uint32_t particle;  ///< index into the positions
  std::uint32_t part;      ///< index into the parts: the one on whose surface it lies now
  float depth;             ///< how far it was moved [m]
  Vec3f normal;            ///< outward, of the surface on which it lies now
  Vec3f surfaceVelocity;   ///< of the part's material there [m/s], by its rigid motion; times LivePart::trust
};

/// Pushes particles of somebody's own simulation out of the live parts. See docs/PARTICLES.md.
///
///     push.prepare(body.parts(), seconds);                          // once a frame
///     for (const ParticleTouch& touch : push.push(positions)) {     // as often as the simulation likes
///       velocities[touch.particle] += velocityChange(touch, velocities[touch.particle], friction);
///     }
///
/// A particle that is inside the union of the hulls is put on its surface, near where it was. Afterwards none is inside
/// any hull by more than a few thousandths of a millimetre (for a body of human size). The same bits for any number of
/// threads and on every instruction set. Nothing is allocated but when there are more parts, faces or particles than
/// ever before.
class ParticlePush {
 public:
  explicit ParticlePush(const ParticlePushSettings& settings = {});
  ~ParticlePush();
  ParticlePush(ParticlePush&&) noexcept;
  ParticlePush& operator=(ParticlePush&&) noexcept;

  /// Takes the parts as they are now; keeps no reference. Parts without triangles (flat ones), in no finite
  /// place or a thousand kilometres away push nothing.
  /// @param seconds  since the last call, above 0
  /// @param again    these are the parts of the last call, moved on by a part of a frame: which faces lead into other
  ///                 parts is taken from there. That only guides, and saves most of the time for hulls of many faces.
  void prepare(std::span<const LivePart> parts, double seconds, bool again = false);

  /// Moves the particles that are inside. Positions that are no numbers are left as they are.
  /// @param positions  world [m]
  /// @return the particles that were moved, by ascending index; good until the next call
  std::span<const ParticleTouch> push(std::span<Vec3f> positions);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What touching does to a particle's velocity [m/s]: it goes no slower along the normal than the surface does, and
/// friction takes from its sliding up to `friction` times that change.
/// @param velocity  before [m/s]
/// @param friction  Coulomb's coefficient; 0 slides freely
[[nodiscard]] Vec3f velocityChange(const ParticleTouch& touch, const Vec3f& velocity, float friction = 0.0F);

}  // namespace lorica
