#pragma once

#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"

#include <span>
#include <vector>

namespace lorica {

/// A head above shoulders, as seen in one frame.
struct FoundHead {
  int column = 0, row = 0;         ///< its middle [cells]
  std::uint16_t depthMm = 0;       ///< there
  Vec3f position = Vec3f::Zero();  ///< of the surface there, floor frame [m]
  int hits = 0;                    ///< how many cells voted for it
};

/// Finds heads by their outline: something head-sized that stands out from what is beside and above it, with shoulders
/// and a chest below at about the same depth. It needs no background and no connected surface, so it works for people
/// who lean on furniture or touch each other. Furniture may look like a head: what is found is only where to look.
class HeadFinder {
 public:
  explicit HeadFinder(const DepthGrid& grid);

  /// @param floorFound  whether y = 0 is the floor: what is as low as a knee is then no head
  /// @return distinct heads, those with the most votes first; valid until the next call
  std::span<const FoundHead> find(const DepthGrid& grid, const FloorPositions& positions, bool floorFound);

 private:
  float cellsPerMetre_;  ///< at a depth of 1 m
  std::vector<FoundHead> votes_, heads_;
};

}  // namespace lorica
