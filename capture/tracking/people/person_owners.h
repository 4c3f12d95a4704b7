#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/people/people_scene.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

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
  void refuse(const Vec3f& middle, double time) { atHeads_.refuse(middle, time); }
  /// Cells of people found at a head whose background must be forgotten: it had a person in it.
  [[nodiscard]] std::span<const std::uint32_t> uncovered() const { return atHeads_.uncovered(); }
  /// Whether a surface was given to one person as a whole, or nearly so.
  [[nodiscard]] bool isOf(std::size_t component, int slot) const { return owner_[component] == slot; }
  /// Whether a surface may be a person for whom no slot is free.
  [[nodiscard]] bool mayBeSomeone(std::size_t component) const;

 private:
  /// Expected position of a person who touches others.
  struct SplitShare {
    int columns = 0, rows = 0;     ///< expected motion of the person in the image since the last frame [cells]
    Vec3f middle = Vec3f::Zero();  ///< of the person's points now, floor frame [m]
  };

  void assign(const PeopleScene& scene, PersonSlots& slots);
  void findNewcomers(const PeopleScene& scene, PersonSlots& slots);
  bool separateHeads(const PeopleScene& scene, std::size_t component, int slot, PersonSlots& slots);
  [[nodiscard]] std::array<float, kPersonSlots> gapsTo(const PeopleScene& scene, std::size_t component,
                                                       float max) const;
  void joinPieces(const PeopleScene& scene, PersonSlots& slots);
  void give(const PeopleScene& scene, std::size_t component, int slot, PersonSlots& slots);
  /// Divides a surface between people who touch. Cells around a person's axis are theirs. So are the cells where they
  /// were in the last frame, moved along, at about that depth, unless they are much nearer to another's axis. The
  /// remaining cells go to the person whose cells are the fewest steps away, crossing small depth steps first.
  /// @param slotMask  people who may receive cells
  void splitBetween(const PeopleScene& scene, std::size_t component, unsigned slotMask, PersonSlots& slots,
                    const LastCells& last);
  void grow(const PeopleScene& scene, std::int32_t label, float steps);
  [[nodiscard]] bool isDenied(const PeopleScene& scene, const DepthComponent& one, int slot,
                              const PersonSlots& slots) const;
  [[nodiscard]] SplitShare shareOf(const PeopleScene& scene, const PersonSlot& slot) const;

  DepthCamera camera_;
  PeopleAtHeads atHeads_;
  std::vector<std::uint8_t> person_;
  std::vector<std::uint32_t> queue_;       ///< of splitBetween()
  std::vector<std::uint8_t> nobody_;       ///< zeros
  std::array<int, kPersonSlots> known_{};  ///< cells of people that the network affirms
  std::vector<int> owner_;                 ///< of components: slot, or a special value of person_owners.cpp
};

}  // namespace lorica
