#pragma once

#include "capture/skeleton_frame.h"

#include <cstdint>
#include <vector>

namespace lorica {

/// Seed of the shipped *_noisy.csv.
inline constexpr std::uint64_t kSensorNoiseSeed = 2026;

/// Adds the errors of a depth sensor at (0, 1.1, 3.2): jitter that increases with distance, limbs lost for 0.1 to 1 s
/// (confidence 0, stale position, no orientation), guesses before and after (0.5). Same seed, same result.
[[nodiscard]] std::vector<SkeletonFrame> addSensorNoise(std::vector<SkeletonFrame> frames, std::uint64_t seed);

}  // namespace lorica
