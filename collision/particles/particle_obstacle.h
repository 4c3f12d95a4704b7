#pragma once

#include "collision/live/live_part.h"
#include "collision/particles/particle_grid.h"
#include "collision/particles/particle_push.h"
#include "geometry/math.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Allowed positions of particles' centres: above the floor and between walls.
struct ParticleRoom {
  Vec3f min = Vec3f::Constant(-1e3f);
  Vec3f max = Vec3f::Constant(1e3f);

  [[nodiscard]] Vec3f nearest(const Vec3f& position) const { return position.cwiseMax(min).cwiseMin(max); }
};
/// @param floor   at y = 0
/// @param walls   only its x and z range is used
/// @param radius  min distance of centres from both [m]
[[nodiscard]] ParticleRoom particleRoom(bool floor, const std::optional<Aabb>& walls, double radius);

/// Interpolates a rigid motion: linear translation and nearly uniform rotation. Without trigonometry, so that every
/// machine gives the same result.
[[nodiscard]] Isometry3 between(const Isometry3& from, const Isometry3& to, double fraction);

/// The avatar as an obstacle to simulated particles: its parts move through a frame in substeps and push particles out.
/// Allocates only for more or larger parts than ever before.
class ParticleObstacle {
 public:
  /// @param radius  of the particles [m]
  explicit ParticleObstacle(double radius);

  /// Starts a frame. A part faster than 25 m/s (a tracker's jump) is moved to its new pose at once.
  void begin(std::span<const LivePart> parts, double seconds, int substeps);
  /// Moves the parts to their poses at the end of a substep; substeps must increase.
  void advance(int substep);

  /// Box around the volume that a part sweeps in the frame.
  struct Sweep {
    std::array<float, 3> min, max;  ///< world [m]
    bool moves;                     ///< whether the part differs from the previous frame
  };
  /// Of the parts that have a valid pose and a shape.
  [[nodiscard]] std::span<const Sweep> sweeps() const { return sweeps_; }

  /// Pushes particles out of the parts and keeps them in the room: a particle that would be pushed into a wall or the
  /// floor takes the shortest of several other ways out.
  /// @param positions  world [m]
  /// @return those that were moved, see ParticlePush::push()
  std::span<const ParticleTouch> push(std::span<Vec3f> positions, const ParticleRoom& room);

 private:
  [[nodiscard]] Vec3f wayOut(const Vec3f& position, const ParticleRoom& room) const;

  struct Motion {
    Isometry3 from = Isometry3::Identity(), to = Isometry3::Identity();
  };
  /// A part's faces, moved outward by the radius, in the part's frame.
  struct Faces {
    std::size_t first = 0, end = 0;  // of planes_
    Aabb box;
  };
  struct Plane {
    Vec3 normal;
    double offset;
  };
  [[nodiscard]] double exitOf(const Faces& faces, const Vec3& from, const Vec3& along) const;
  void takeFaces(const LivePart& part);

  double radius_;
  double substepSeconds_ = 0.0;
  int substeps_ = 1;
  int done_ = 0;  // finished substeps of the frame
  ParticlePush push_;
  std::vector<LivePart> parts_;
  std::vector<Motion> motions_;
  std::vector<Faces> faces_;  // of each part
  std::vector<Plane> planes_;
  std::vector<Sweep> sweeps_;
};

}  // namespace lorica
