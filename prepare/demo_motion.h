#pragma once

#include "prepare/read_motion.h"

namespace lorica {

/// The motion of the demo: excerpts of shipped recordings, concatenated and cross-faded. Each starts at the position of
/// the feet at the end of the previous one. Frames at 30 Hz from time 0.
/// @return joints named "kick and walk", or an error if a shipped recording cannot be read
[[nodiscard]] Result<Motion> makePerformance();

}  // namespace lorica
