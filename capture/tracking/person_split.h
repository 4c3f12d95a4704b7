#pragma once

#include "capture/tracking/components.h"
#include "capture/tracking/depth_grid.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Where someone who touches others is expected.
struct SplitShare {
  int columns = 0, rows = 0;     ///< how far the person moves in the image since the last frame [cells]
  Vec3f middle = Vec3f::Zero();  ///< of the person's points now, floor frame [m]
};

/// Shares a surface out between people who touch.
class PersonSplit {
 public:
  explicit PersonSplit(const DepthGrid& grid) { queue_.reserve(grid.cellCount()); }

  /// Cells around the axis of one of them are his; so are those where he was, moved along, at about that depth, unless
  /// they are much nearer to another's axis. The rest goes to whoever's cells are the fewest steps away, over small
  /// steps of depth first.
  /// @param slotMask  those who may have a share
  /// @param shares    one a slot
  /// @param person    slot + 1 of each cell; written for the cells of the component
  void apply(const DepthGrid& grid, const ComponentFinder& finder, const FloorPlaces& places, std::size_t component,
             unsigned slotMask, std::span<const SplitShare> shares, const LastCells& last,
             std::span<std::uint8_t> person);

 private:
  void grow(const DepthGrid& grid, const ComponentFinder& finder, std::int32_t label, float steps,
            std::span<std::uint8_t> person);

  std::vector<std::uint32_t> queue_;
};

}  // namespace lorica
