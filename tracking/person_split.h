#pragma once

#include "tracking/components.h"
#include "tracking/depth_grid.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// How far a person moves in the image from one frame to the next [cells].
struct CellShift {
  int columns = 0;
  int rows = 0;
};

/// Shares a surface out between people who touch.
class PersonSplit {
 public:
  explicit PersonSplit(const DepthGrid& grid) { queue_.reserve(grid.cellCount()); }

  /// Cells where one of them was, moved along, at about that depth, are his; the rest goes to whoever's cells are the
  /// fewest steps away.
  /// @param slotMask  those who may have a share
  /// @param person    slot + 1 of each cell; written for the cells of the component
  void apply(const DepthGrid& grid, const ComponentFinder& finder, std::size_t component, unsigned slotMask,
             std::span<const CellShift> shifts, const LastCells& last, std::span<std::uint8_t> person);

 private:
  std::vector<std::uint32_t> queue_;
};

}  // namespace lorica
