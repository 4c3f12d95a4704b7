#pragma once

#include "capture/tracking/components.h"
#include "capture/tracking/depth_grid.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Tells people from furniture that is taken for a person: it remembers what each one covered when found, and sees
/// whether that changes. Needs no background to be known, so that sitting down counts as much as an arm raised.
class PersonMoves {
 public:
  explicit PersonMoves(const DepthGrid& grid);

  /// Remembers what a person covers now.
  /// @param person  slot + 1 of each cell
  void remember(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot);

  /// @return whether so much of what the person covered when remembered shows another depth now that it moved: deeper,
  ///         or nearer and the person's. Edges, which noise moves by a cell, do not count
  [[nodiscard]] bool hasMoved(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot) const;

 private:
  std::array<std::vector<std::uint16_t>, kPersonSlots> depthMm_;  ///< 0 where the person was not
  std::array<int, kPersonSlots> cells_{};
  DepthTable tolerance_;  ///< [m]
};

}  // namespace lorica
