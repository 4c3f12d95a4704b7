#pragma once

#include "capture/synthetic/synthetic_motion.h"
#include "prepare/motion.h"

namespace lorica {

/// A shipped recording made again, equal bit for bit to what its file gives.
[[nodiscard]] Motion shippedMotion(SyntheticMotion which);

}  // namespace lorica
