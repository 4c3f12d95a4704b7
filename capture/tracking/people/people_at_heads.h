#pragma once

#include "capture/tracking/people/people_scene.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Finds people whose surface is no person's, because it is connected to furniture or learnt as background: at heads
/// that are found twice in the same position.
class PeopleAtHeads {
 public:
  explicit PeopleAtHeads(const DepthGrid& grid);

  /// @param slots   newcomers occupy free ones
  /// @param person  slot + 1 of each cell: newcomers get cells that are nobody's
  void find(const PeopleScene& scene, PersonSlots& slots, std::span<std::uint8_t> person);
  /// No head is looked for near this position for some seconds.
  /// @param middle  floor frame [m]
  void refuse(const Vec3f& middle, double time);
  /// Cells of the people found by the last call of find().
  [[nodiscard]] std::span<const std::uint32_t> uncovered() const { return uncovered_; }

 private:
  [[nodiscard]] bool isRefused(const Vec3f& axis, double time) const;
  bool growFrom(const PeopleScene& scene, const FoundHead& head, int slot, std::span<std::uint8_t> person);

  struct Refusal {
    Vec3f middle = Vec3f::Zero();
    double until = 0.0;  ///< [s]
  };
  std::array<Refusal, 16> refusals_{};
  std::size_t nextRefusal_ = 0;
  std::vector<Vec3f> waiting_, stillWaiting_;  ///< axes of heads that are nobody's since the last search
  std::vector<std::uint32_t> uncovered_, region_;
};

}  // namespace lorica
