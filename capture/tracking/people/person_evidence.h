#pragma once

#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/segmentation/person_network.h"

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

}  // namespace lorica
