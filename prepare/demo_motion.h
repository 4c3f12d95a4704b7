#pragma once

#include "prepare/cast.h"

namespace lorica {

/// The motion of the demo: excerpts of shipped recordings, concatenated and cross-faded. Each starts at the position of
/// the feet at the end of the previous one. Frames at 30 Hz from time 0.
/// @return joints named "kick and walk", or an error if a shipped recording cannot be read
[[nodiscard]] Result<Motion> makeDemoMotion(Host& host);

/// The demo: a humanoid, that motion, boxes and balls. Another character performs its own clip, or stands.
struct DemoCast {
  Cast cast;
  bool fromCache = false;  ///< the decomposition
  double seconds = 0.0;    ///< of computing it
};
[[nodiscard]] Result<DemoCast> prepareDemo(const std::string& character, Host& host);

}  // namespace lorica
