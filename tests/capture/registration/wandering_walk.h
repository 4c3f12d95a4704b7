#pragma once

#include "capture/skeleton_frame.h"

#include <cstdint>
#include <vector>

namespace lorica::test {

/// The walk on the spot, taken along curves in a small room, with a head that looks around: 30 frames a second.
/// @param room  at this distance from where they began they turn back [m]
[[nodiscard]] std::vector<SkeletonFrame> wanderingWalk(double seconds, std::uint64_t seed, double room = 0.8);

}  // namespace lorica::test
