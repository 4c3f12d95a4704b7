#pragma once

#include "apps/inputs.h"

namespace lorica {

/// What the demo's character does: shipped recordings one after the other, the person walking on from where the last
/// one ended, with a short cross-fade between them.
[[nodiscard]] Result<Recording> makePerformance();

}  // namespace lorica
