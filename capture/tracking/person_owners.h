#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/background.h"
#include "capture/tracking/components.h"
#include "capture/tracking/depth_grid.h"
#include "capture/tracking/head_finder.h"
#include "capture/tracking/person_slot.h"
#include "capture/tracking/person_split.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

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

/// Assigns surfaces to people from frame to frame: to those already present, to newcomers, and to those who return.
class PersonOwners {
 public:
  PersonOwners(const DepthGrid& grid, const DepthCamera& camera);

  /// @param slots  `seen` is reset; newcomers occupy free slots
  void share(const PeopleScene& scene, PersonSlots& slots);

  /// Slot + 1 of each cell; the caller may remove cells from a person.
  [[nodiscard]] std::span<const std::uint8_t> person() const { return person_; }
  [[nodiscard]] std::span<std::uint8_t> person() { return person_; }
  /// A surface there is no person: no head is looked for near it for some seconds.
  /// @param middle  floor frame [m]
  void refuse(const Vec3f& middle, double time);
  /// Cells of people found at a head whose background must be forgotten: it had a person in it.
  [[nodiscard]] std::span<const std::uint32_t> uncovered() const { return uncovered_; }
  /// Whether a surface may be a person for whom no slot is free.
  [[nodiscard]] bool mayBeSomeone(std::size_t component) const;

 private:
  void assign(const PeopleScene& scene, PersonSlots& slots);
  void giveBirth(const PeopleScene& scene, PersonSlots& slots);
  void giveBirthAtHeads(const PeopleScene& scene, PersonSlots& slots);
  bool separateHeads(const PeopleScene& scene, std::size_t component, int slot, PersonSlots& slots);
  bool growFrom(const PeopleScene& scene, const FoundHead& head, int slot);
  void joinPieces(const PeopleScene& scene, PersonSlots& slots);
  void give(const PeopleScene& scene, std::size_t component, int slot, PersonSlots& slots);
  void splitBetween(const PeopleScene& scene, std::size_t component, unsigned slotMask, PersonSlots& slots,
                    const LastCells& last);
  [[nodiscard]] SplitShare shareOf(const PeopleScene& scene, const PersonSlot& slot) const;

  DepthCamera camera_;
  PersonSplit split_;
  std::vector<std::uint8_t> person_;
  struct Refusal {
    Vec3f middle = Vec3f::Zero();
    double until = 0.0;  ///< [s]
  };
  std::array<Refusal, 16> refusals_{};
  std::size_t nextRefusal_ = 0;
  std::vector<Vec3f> waiting_, stillWaiting_;  ///< axes of heads that are nobody's since the last search
  std::vector<std::uint32_t> uncovered_, region_;
  std::vector<std::uint8_t> nobody_;  ///< zeros
  std::vector<int> owner_;            ///< of components: slot, or a special value of person_owners.cpp
};

}  // namespace lorica
