#pragma once

#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Expected position of a person who touches others.
struct SplitShare {
  int columns = 0, rows = 0;     ///< expected motion of the person in the image since the last frame [cells]
  Vec3f middle = Vec3f::Zero();  ///< of the person's points now, floor frame [m]
};

/// Divides a surface between people who touch.
class PersonSplit {
 public:
  explicit PersonSplit(const DepthGrid& grid) { queue_.reserve(grid.cellCount()); }

  /// Cells around a person's axis are theirs. So are the cells where they were in the last frame, moved along, at about
  /// that depth, unless they are much nearer to another's axis. The remaining cells go to the person whose cells are
  /// the fewest steps away, crossing small depth steps first.
  /// @param slotMask  people who may receive cells
  /// @param shares    one per slot
  /// @param person    slot + 1 of each cell; written for the cells of the component
  void apply(const DepthGrid& grid, const ComponentFinder& finder, const FloorPositions& positions,
             std::size_t component, unsigned slotMask, std::span<const SplitShare> shares, const LastCells& last,
             std::span<std::uint8_t> person);

 private:
  void grow(const DepthGrid& grid, const ComponentFinder& finder, std::int32_t label, float steps,
            std::span<std::uint8_t> person);

  std::vector<std::uint32_t> queue_;
};

}  // namespace lorica
