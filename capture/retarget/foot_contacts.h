#pragma once

#include "capture/retarget/root_and_feet.h"

#include <span>
#include <vector>

namespace lorica {

/// Frames first to last, inclusive, in which a foot stands.
struct FootContact {
  int first = 0;
  int last = 0;
};

/// Floor height under a motion: the height that the lower sole rarely goes below [m].
/// @param left, right  of the same frames, at least one
[[nodiscard]] double floorUnder(std::span<const FootPosition> left, std::span<const FootPosition> right);

/// Finds the intervals in which a foot stands: ankle or ball moves little from frame to frame and the sole is near the
/// floor, with hysteresis (stricter limits to start than to continue). A foot in the air also counts if the whole foot
/// rests for 0.25 s. Uses steps between adjacent frames instead of slopes over several, so that the first and last
/// frame of a stance are found.
/// @param positions  one per frame
/// @param times      [s], increasing
/// @param legLength  leg length of the moving body; limits hold for 0.85 m and scale with it [m]
[[nodiscard]] std::vector<FootContact> contactsOf(std::span<const FootPosition> positions,
                                                  std::span<const double> times, double floor, double legLength);

}  // namespace lorica
