#pragma once

#include "geometry/math.h"

#include <span>
#include <vector>

namespace lorica {

/// A foot at one time, as a motion has it.
struct FootPlace {
  Vec3 ankle = Vec3::Zero();  ///< world [m]
  Vec3 ball = Vec3::Zero();   ///< of the sole, under the toes' joint
  double lowest = 0.0;        ///< height of the lowest point of the sole [m]
};

/// Frames first to last, both included, in which a foot stands.
struct FootContact {
  int first = 0;
  int last = 0;
};

/// Where the floor is under a motion: the height that the lower sole seldom goes below [m].
/// @param left, right  of the same frames, at least one
[[nodiscard]] double floorUnder(std::span<const FootPlace> left, std::span<const FootPlace> right);

/// The times in which a foot stands: ankle or ball moves little from one frame to the next and the sole is near the
/// floor, each with a narrower bound to begin than to go on; or in the air, when the whole foot rests for 0.25 s.
/// Steps between frames count, not slopes over several, so that the first and last frames of a stance are found.
/// @param places     one a frame
/// @param times      [s], rising
/// @param legLength  of the body that moves: bounds are for 0.85 m and grow with it [m]
[[nodiscard]] std::vector<FootContact> contactsOf(std::span<const FootPlace> places, std::span<const double> times,
                                                  double floor, double legLength);

}  // namespace lorica
