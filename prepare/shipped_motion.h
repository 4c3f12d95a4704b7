#pragma once

#include "capture/synthetic/synthetic_motion.h"
#include "prepare/motion.h"

#include <optional>
#include <string>

namespace lorica {

/// A shipped recording made again, equal bit for bit to what its file gives.
[[nodiscard]] Motion shippedMotion(SyntheticMotion which);
/// By its name, such as "walk"; none if no joints are shipped by that name.
[[nodiscard]] std::optional<Motion> shippedMotion(const std::string& name);

}  // namespace lorica
