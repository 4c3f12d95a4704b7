#pragma once

#include "collision/live/live_part.h"
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

struct GranularSettings {
  std::size_t capacity = 200'000;       ///< max number of grains
  double radius = 0.01;                 ///< of a grain [m]
  double friction = 0.4;                ///< Coulomb's coefficient, among grains, with the floor and the body
  Vec3 gravity{0.0, -9.81, 0.0};        ///< [m/s^2]
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
  explicit Granular(const GranularSettings& settings);

  /// Adds grains up to the capacity; ideally they do not overlap.
  /// @param positions  centres, world [m]; non-finite ones are skipped
  /// @return how many were added
  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity = Vec3::Zero());

  /// Moves the grains from the last frame to this one; the parts move from their previous to their present pose.
  /// @param seconds  above 0
  void step(std::span<const LivePart> parts, double seconds);

  [[nodiscard]] std::size_t size() const { return count_; }
  /// Centres, in the order in which they were added [m].
  [[nodiscard]] std::span<const Vec3f> positions() const { return {positions_.data(), count_}; }
  [[nodiscard]] std::span<const Vec3f> velocities() const { return {velocities_.data(), count_}; }
  [[nodiscard]] const GranularSettings& settings() const { return settings_; }
  /// Grains that were not at rest in the last substep.
  [[nodiscard]] std::size_t awakeCount() const;

 private:
  void wakeAroundParts();
  void sort(float seconds);
  void findNeighbours();
  void stepContacts(float seconds);
  void pushOut(float seconds);
  void rouse(float seconds);

  GranularSettings settings_;
  ParticleRoom room_;  // of centres
  float diameter_;
  std::size_t count_ = 0;
  float motionSeconds_;  // of the substeps that the motions belong to
  // In the order of the last sorting, those of the next substep, and working memory for sorting.
  std::vector<ParticleRow> position_, motion_, nextPosition_, nextMotion_;
  std::vector<std::uint32_t> id_, nextId_;
  std::vector<float> x_, y_, z_;  // positions for the neighbour search
  std::vector<std::uint8_t> asleep_, woken_, nearBody_;
  ParticleGrid grid_;
  NeighbourLists lists_;
  ParticleObstacle body_;
  std::vector<Vec3f> candidates_;  // grains that the body may touch
  std::vector<std::uint32_t> candidateOf_;
  std::vector<Vec3f> positions_, velocities_;  // by id
};

}  // namespace lorica
