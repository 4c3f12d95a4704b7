#pragma once

#include "geometry/math.h"

#include <array>
#include <optional>

namespace lorica {

/// What a headset tells of its wearer, in a frame with Y up and the floor at y = 0 [m].
struct HeadAndHands {
  double time = 0.0;                              ///< [s]
  Isometry3 head = Isometry3::Identity();         ///< between the eyes; looks along its -Z, +X to the right
  std::array<std::optional<Isometry3>, 2> hands;  ///< left, right: grip poses of OpenXR and WebXR; none = not seen
};

}  // namespace lorica
