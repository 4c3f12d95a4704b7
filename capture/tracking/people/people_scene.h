#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/people/background.h"
#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/people/head_finder.h"
#include "capture/tracking/people/person_slot.h"
#include "capture/tracking/people/person_split.h"

#include <array>
#include <span>

namespace lorica {

using PersonSlots = std::array<PersonSlot, kPersonSlots>;

/// The content of a frame before its surfaces are assigned to people.
struct PeopleScene {
  const DepthGrid& grid;
  const FloorPositions& positions;
  const ComponentFinder& surfaces;
  std::span<const CellKind> kinds;
  LastCells last;
  std::span<const FoundHead> heads;
  bool looked = false;  ///< for heads, in this frame
  Isometry3 floorFromCamera;
  bool floorFound = false;
  double time = 0.0, elapsed = 0.0;  ///< of the frame, and since the last one [s]
};

inline constexpr float kHeadsApart = 0.3F;        ///< between two people's heads, horizontally [m]
inline constexpr float kMinVisibleArea = 0.12F;   ///< of a person [m^2]
inline constexpr float kMinVisibleHeight = 0.4F;  ///< of a person [m]

/// Length along the floor.
[[nodiscard]] float horizontally(const Vec3f& v);
/// Where the middle of a person should be in this frame; floor frame [m].
[[nodiscard]] Vec3f expectedMiddle(const PeopleScene& scene, const PersonSlot& slot);
/// The middle of a head, behind its surface; floor frame [m].
[[nodiscard]] Vec3f axisOf(const PeopleScene& scene, const FoundHead& head);
/// @return -1 if there is none
[[nodiscard]] int freeSlot(const PersonSlots& slots);
[[nodiscard]] PersonSlot newcomer(const PeopleScene& scene, const Vec3f& middle);

}  // namespace lorica
