#pragma once

#include "capture/skeleton_frame.h"

#include <string_view>
#include <vector>

namespace lorica {

/// Joints of a person of about 1.75 m at 30 Hz, without noise, every confidence 1. The same on every machine.
/// @param name  one of kShippedMotions
[[nodiscard]] std::vector<SkeletonFrame> synthesizeMotion(std::string_view name);

/// Rounds as the shipped files do: to 0.01 mm, 0.00001 of a quaternion component and 1 us. That is finer than any
/// tracker, and keeps files small.
void roundForFile(std::vector<SkeletonFrame>& frames);

}  // namespace lorica
