#pragma once

#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/segmentation/person_network.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// What the network says of each cell of a grid, smoothed over a few frames.
class PersonEvidence {
 public:
  explicit PersonEvidence(const DepthGrid& grid);

  /// Allocates nothing.
  void update(const DepthGrid& grid, const FloorPositions& positions, bool floorFound);

  /// For each cell a logit, positive for people; 256 is 1.0. 0 where nothing is measured.
  [[nodiscard]] std::span<const std::int16_t> logits() const { return logits_; }

 private:
  PersonNetwork network_;
  float scale_ = 2.0F;                  ///< cells along a side of a pixel of the network
  int top_ = 0;                         ///< the network's first row that shows the image
  std::vector<std::uint16_t> depthMm_;  ///< the network's input
  std::vector<std::int16_t> heightMm_;
  std::vector<std::int16_t> logits_;
  std::vector<std::uint16_t> lastDepthMm_;
};

/// Distinguishes people from furniture mistaken for a person: remembers what each one covered when found, and detects
/// changes. No known background is needed, so sitting down counts as much as raising an arm.
class PersonMoves {
 public:
  explicit PersonMoves(const DepthGrid& grid);

  /// Remembers what a person covers now.
  /// @param person  slot + 1 of each cell
  void remember(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot);

  /// @return whether enough has changed since: of the area that the person covered then, what shows another depth now
  /// (deeper, or nearer and the person's); of the area that they cover now, what was deeper then or not measured.
  /// Edges, which noise moves by a cell, do not count
  [[nodiscard]] bool hasMoved(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot) const;

 private:
  std::array<std::vector<std::uint16_t>, kPersonSlots> depthMm_;  ///< of the whole image
  std::array<std::vector<std::uint8_t>, kPersonSlots> covered_;   ///< whether the cell was the person's
  std::array<int, kPersonSlots> cells_{};
  DepthTable tolerance_;  ///< [m]
};

}  // namespace lorica
