#pragma once

#include "collision/particles/particle_grid.h"
#include "geometry/math.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// How much of its own weight water holds up, wherever there is water: pressures on a coarse grid that would keep it
/// from accelerating if it stood still. Falling water has none. Internal to Fluid.
///
/// Depends on where the drops are, not on how they move. Does not allocate. Same bits for any number of threads and
/// with any compiler.
class StandingWater {
 public:
  /// @param spacing  of drops at rest [m]
  /// @param min      floor and walls; infinite, or very far, where there are none [m]
  StandingWater(std::size_t capacity, float spacing, const Vec3f& min, const Vec3f& max);

  /// A box around something that is no water [m].
  struct Solid {
    Vec3f min, max;
  };
  /// @param positions  finite
  /// @param solids     the water around them is held less, that near them not at all
  void find(std::span<const ParticleRow> positions, const Vec3f& gravity, std::span<const Solid> solids);

  /// The acceleration that this pressure gives one of the drops [m/s^2]; w: how much of the pressure is held here, 0
  /// to 1.
  [[nodiscard]] ParticleRow lift(std::size_t drop, const ParticleRow& at) const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  using Place = std::array<std::int32_t, 3>;
  struct Cell {
    Place at;
    std::uint32_t drops = 0;
    float share = 0.0f;                  // see Row
    std::array<float, 3> low{}, high{};  // accelerations on its faces
  };
  // A cell that is full enough, as an equation.
  struct Row {
    std::uint32_t cell;
    std::array<std::uint32_t, 3> before, after;  // rows of its neighbours
    std::array<bool, 3> wallBefore, wallAfter;
    float diagonal, factor, right, pressure, search, image, solved;  // pressure over density [m^2/s^2]
    float share;                                                     // that is held up
  };
  [[nodiscard]] Place cellAt(const ParticleRow& p) const;
  [[nodiscard]] std::uint32_t& slotOf(const Place& at);
  [[nodiscard]] bool isWall(Place at, std::size_t axis, int step) const;
  void makeRows(const Vec3f& gravity);
  void solve();
  void findShares(std::span<const Solid> solids, Eigen::Index up);
  [[nodiscard]] Vec3f middleOf(const Row& row) const;
  void precondition();

  float full_;  // drops in a full cell
  Vec3f origin_, size_, perSize_, weight_;
  Place first_, last_;                // cells between the walls
  std::vector<std::uint32_t> table_;  // cells by place: open addressing
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> cellOf_;  // of each drop
  std::vector<std::uint32_t> rowOf_;   // of each cell
  std::vector<Row> rows_;
};

}  // namespace lorica
