#pragma once

#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"

#include <cstdint>
#include <span>

namespace lorica {

/// Too wide, too high or too large in area for one person: merged with something else.
[[nodiscard]] bool isOversize(const DepthComponent& one);

/// Its border continues smoothly into known background: a part of the room that was hidden until now.
[[nodiscard]] bool goesOnIntoBackground(const DepthComponent& one);

/// So near that the network cannot judge it: it was shown nobody nearer than this.
[[nodiscard]] bool isTooNear(const DepthComponent& one, const DepthGrid& grid);

/// Whether the network takes most of it for a person's.
[[nodiscard]] bool isAffirmed(const DepthComponent& one);

/// Whether most of a person's cells of the last frame lie on it.
/// @param cells  of that person in the last frame
[[nodiscard]] bool isMainPiece(const DepthComponent& one, int cells, int slot);

/// Size, height and thickness are plausible for a person, or for the part of one inside the image.
[[nodiscard]] bool mayBePerson(const DepthComponent& one, const DepthGrid& grid, bool floorFound);

/// Large enough to be the first visible part of a person who reappears from behind something.
[[nodiscard]] bool mayBePartOfPerson(const DepthComponent& one);

/// Narrow at the top and wider below.
/// @param person    slot + 1 of each cell
/// @param top       height of the person [m]
/// @param cutAside  one side of the person is outside the image: half of either width is enough
[[nodiscard]] bool hasHeadAndShoulders(const DepthGrid& grid, const FloorPositions& positions,
                                       std::span<const std::uint8_t> person, int slot, float top, bool cutAside);

}  // namespace lorica
