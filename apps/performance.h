#pragma once

#include "apps/motions.h"

namespace lorica {

/// What the demo's character does: pieces of shipped recordings one after the other, cross-faded, each starting where
/// the feet of the one before stand. Frames at 30 Hz from time 0.
/// @return joints named "kick and walk", or which shipped recording could not be read
[[nodiscard]] Result<Motion> makePerformance();

}  // namespace lorica
