#pragma once

#include "capture/tracking/people/depth_grid.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Tells whether the camera moves: what it sees besides people changes everywhere, and the more the longer one waits,
/// unlike noise.
class CameraMotion {
 public:
  explicit CameraMotion(const DepthGrid& grid);

  /// @param grid     of the present frame
  /// @param last     depth of the frame before [mm]
  /// @param covered  for each cell, nonzero if a person was there in the frame before
  /// @param time     [s]
  /// @return whether the camera moves, or did a second ago
  bool update(const DepthGrid& grid, std::span<const std::uint16_t> last, std::span<const std::uint8_t> covered,
              double time);

 private:
  /// The share of the cells that are nearer or farther than before.
  [[nodiscard]] float changedSince(const DepthGrid& grid, std::span<const std::uint16_t> before,
                                   std::span<const std::uint8_t> covered) const;

  std::vector<std::uint16_t> before_;  ///< some frames ago [mm]
  std::vector<std::uint8_t> covered_;  ///< then
  DepthTable tolerance_;               ///< [m]
  int age_ = 0;                        ///< frames since then
  double until_ = -1.0;                ///< [s]
};

}  // namespace lorica
