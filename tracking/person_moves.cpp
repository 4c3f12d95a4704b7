#include "tracking/person_moves.h"

#include <algorithm>

namespace lorica {

namespace {

constexpr int kLeftShare = 12;  ///< a twelfth of what was covered
constexpr int kEdgeCells = 2;   ///< at either end of a row of cells that show something else, noise may have done it

}  // namespace

PersonMoves::PersonMoves(const DepthGrid& grid)
    : tolerance_([](double depth) { return 0.03F + 5.0F * depthNoise(static_cast<float>(depth)); }) {
  for (std::vector<std::uint16_t>& depth : depthMm_) depth.resize(grid.cellCount());
}

void PersonMoves::remember(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot) {
  const auto k = static_cast<std::size_t>(slot);
  cells_[k] = 0;
  for (std::size_t i = 0; i < person.size(); ++i) {
    const bool mine = person[i] == slot + 1;
    depthMm_[k][i] = mine ? grid.depthMm[i] : std::uint16_t{0};
    cells_[k] += static_cast<int>(mine);
  }
}

bool PersonMoves::hasLeft(const DepthGrid& grid, int slot) const {
  const std::vector<std::uint16_t>& was = depthMm_[static_cast<std::size_t>(slot)];
  int left = 0;
  for (int r = 0; r < grid.height; ++r) {
    int run = 0;
    for (int c = 0; c <= grid.width; ++c) {
      const std::size_t i = grid.index(std::min(c, grid.width - 1), r);
      const bool deeper =
          c < grid.width && was[i] != 0 &&
          static_cast<float>(grid.depthMm[i]) > static_cast<float>(was[i]) + 1000.0F * tolerance_[was[i]];
      if (deeper) {
        ++run;
        continue;
      }
      left += std::max(0, run - 2 * kEdgeCells);
      run = 0;
    }
  }
  return left * kLeftShare > cells_[static_cast<std::size_t>(slot)];
}

}  // namespace lorica
