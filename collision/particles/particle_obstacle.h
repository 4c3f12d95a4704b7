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

/// Where particles' centres may be: above the floor and between walls.
struct ParticleRoom {
  Vec3f least = Vec3f::Constant(-1e3f);
  Vec3f most = Vec3f::Constant(1e3f);
};
/// @param floor   at y = 0
/// @param walls   its x and z count, not its y
/// @param radius  how far centres stay away from both [m]
[[nodiscard]] ParticleRoom particleRoom(bool floor, const std::optional<Aabb>& walls, double radius);

/// The avatar as simulated particles meet it: its parts go through a frame in substeps, and push what they meet.
/// Allocates nothing but for more or larger parts than ever before.
class ParticleBody {
 public:
  /// @param radius  of the particles [m]
  explicit ParticleBody(double radius);

  /// Begins a frame. A part faster than 25 m/s (a tracker's jump) is in its new place at once.
  void begin(std::span<const LivePart> parts, double seconds, int substeps);
  /// Takes the parts to where they are at the end of a substep, a later one than before.
  void advance(int substep);

  /// Box around what a part sweeps in the frame.
  struct Sweep {
    std::array<float, 3> least, most;  ///< world [m]
    bool moves;                        ///< else the part is as it was in the frame before
  };
  /// Of the parts that have a place and a shape.
  [[nodiscard]] std::span<const Sweep> sweeps() const { return sweeps_; }

  /// Pushes particles out of the parts and keeps them in the room: those that find a wall or the floor where they are
  /// pushed to go the shortest of some other ways out.
  /// @param places  world [m]
  /// @return those that were moved, see ParticlePush::push()
  std::span<const ParticleTouch> push(std::span<Vec3f> places, const ParticleRoom& room);

 private:
  [[nodiscard]] Vec3f wayOut(const Vec3f& place, const ParticleRoom& room) const;

  struct Motion {
    Isometry3 from = Isometry3::Identity(), to = Isometry3::Identity();
  };
  /// A part's faces, grown by the radius, in the part's frame.
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
  int done_ = 0;  // substeps of the frame
  ParticlePush push_;
  std::vector<LivePart> parts_;
  std::vector<Motion> motions_;
  std::vector<Faces> faces_;  // of each part
  std::vector<Plane> planes_;
  std::vector<Sweep> sweeps_;
};

}  // namespace lorica
