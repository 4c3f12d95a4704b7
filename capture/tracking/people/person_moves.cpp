#include "capture/tracking/people/person_moves.h"

#include <algorithm>

namespace lorica {

namespace {

constexpr int kMovedShare = 60;  ///< min changed fraction is 1 / this; a forearm moved forward changes twice that
constexpr int kEdgeCells = 2;    ///< at either end of a run of changed cells, possibly caused by noise

}  // namespace

PersonMoves::PersonMoves(const DepthGrid& grid)
    : tolerance_([](double depth) { return 0.03F + 5.0F * depthNoise(depth); }) {
  for (std::vector<std::uint16_t>& depth : depthMm_) depth.resize(grid.cellCount());
  for (std::vector<std::uint8_t>& covered : covered_) covered.resize(grid.cellCount());
}

void PersonMoves::remember(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot) {
  const std::size_t k = slot;
  cells_[k] = 0;
  depthMm_[k] = grid.depthMm;
  for (std::size_t i = 0; i < person.size(); ++i) {
    covered_[k][i] = person[i] == slot + 1;
    cells_[k] += covered_[k][i];
  }
}

bool PersonMoves::hasMoved(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot) const {
  const std::vector<std::uint16_t>& was = depthMm_[slot];
  const std::vector<std::uint8_t>& covered = covered_[slot];
  int changed = 0;
  for (int r = 0; r < grid.height; ++r) {
    int run = 0;
    for (int c = 0; c < grid.width; ++c) {
      const std::size_t i = grid.index(c, r);
      const float off = static_cast<float>(grid.depthMm[i]) - was[i];
      const float tolerance = 1000.0F * tolerance_[std::max(was[i], grid.depthMm[i])];
      const bool mine = person[i] == slot + 1, nearer = off < -tolerance;
      // Something nearer may be someone else in front of the person.
      const bool differs = covered[i] != 0
                               ? was[i] != 0 && grid.depthMm[i] != 0 && (off > tolerance || (nearer && mine))
                               : mine && (was[i] == 0 || nearer);
      run = differs ? run + 1 : 0;
      changed += run > 2 * kEdgeCells;
    }
  }
  return changed * kMovedShare > cells_[slot];
}

}  // namespace lorica
