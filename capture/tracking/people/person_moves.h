#pragma once

#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Distinguishes people from furniture mistaken for a person: remembers what each one covered when found, and detects
/// changes. No known background is needed, so sitting down counts as much as raising an arm.
class PersonMoves {
 public:
  explicit PersonMoves(const DepthGrid& grid);

  /// Remembers what a person covers now.
  /// @param person  slot + 1 of each cell
  void remember(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot);

  /// @return whether enough has changed since: of the area that the person covered then, what shows another depth now
  /// (deeper, or nearer and the person's); of the area that they cover now, what was deeper then or not measured.
  /// Edges, which noise moves by a cell, do not count
  [[nodiscard]] bool hasMoved(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot) const;

 private:
  std::array<std::vector<std::uint16_t>, kPersonSlots> depthMm_;  ///< of the whole image
  std::array<std::vector<std::uint8_t>, kPersonSlots> covered_;   ///< whether the cell was the person's
  std::array<int, kPersonSlots> cells_{};
  DepthTable tolerance_;  ///< [m]
};

}  // namespace lorica
