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
  std::size_t capacity = 200'000;       ///< most grains
  double radius = 0.01;                 ///< of a grain [m]
  double friction = 0.4;                ///< Coulomb's coefficient, among grains, with the floor and the body
  Vec3 gravity{0.0, -9.81, 0.0};        ///< [m/s^2]
  bool floor = true;                    ///< at y = 0
  std::optional<Aabb> walls;            ///< the grains stay within its x and z; its y is of no matter
  double substepSeconds = 1.0 / 240.0;  ///< longest substep; a frame is cut into equal ones
};

/// Dry grains of one size, with contacts and friction among each other: position-based dynamics. The avatar's parts
/// push them. How, and how far it is from sand: docs/PARTICLES.md.
///
/// After a step no grain is deeper than 1 mm in a part, below the floor or beyond a wall. None is faster than a
/// diameter in a substep (4.8 m/s with the default settings). Grains that have come to rest cost little. The same bits
/// for any number of threads and on every instruction set. Stepping allocates nothing after the first frame with a
/// body.
class Granular {
 public:
  explicit Granular(const GranularSettings& settings);

  /// Adds grains while there is room; at best they do not overlap.
  /// @param places  centres, world [m]; those that are no numbers are left out
  /// @return how many were added
  std::size_t add(std::span<const Vec3f> places, const Vec3& velocity = Vec3::Zero());

  /// Moves the grains from the last frame to this one; the parts go from their previous to their present motion.
  /// @param seconds  above 0
  void step(std::span<const LivePart> parts, double seconds);

  [[nodiscard]] std::size_t size() const { return count_; }
  /// Centres, in the order in which they were added [m].
  [[nodiscard]] std::span<const Vec3f> places() const { return {places_.data(), count_}; }
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
  float motionSeconds_;  // of the substeps that the motions are of
  // In the order of the last sorting, the next substep's, and room to change the order.
  std::vector<ParticleRow> place_, motion_, nextPlace_, nextMotion_;
  std::vector<std::uint32_t> id_, nextId_;
  std::vector<float> x_, y_, z_;  // where neighbours are looked for
  std::vector<std::uint8_t> asleep_, woken_, nearBody_;
  ParticleGrid grid_;
  NeighbourLists lists_;
  ParticleBody body_;
  std::vector<Vec3f> candidates_;  // what the body may touch
  std::vector<std::uint32_t> candidateOf_;
  std::vector<Vec3f> places_, velocities_;  // by id
};

}  // namespace lorica
