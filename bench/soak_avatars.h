#pragma once

#include "acd/decomposition.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lorica::bench {

struct AvatarSoakSettings {
  double seconds = 1800.0;  ///< simulated time
  std::uint64_t seed = 1;
  int places = 6;             ///< for avatars
  double memoryGrowth = 4.0;  ///< maximum growth from the first third after the warm-up to the last third [MiB]
  double warmUp = 300.0;      ///< simulated time before memory counts [s]
};

struct AvatarSoakResult {
  double seconds = 0.0, cpuSeconds = 0.0;  ///< simulated, and CPU time of all steps
  long frames = 0, entries = 0, exits = 0, contacts = 0, meetings = 0, events = 0;
  double meanThere = 0.0;                                        ///< avatars in a frame
  double firstMemory = 0.0, lastMemory = 0.0, peakMemory = 0.0;  ///< means of the thirds, and the peak [MiB]
  std::vector<std::string> violations;                           ///< messages of the first few
};

/// A session in the demo's scene whose avatars come and go: each is there for 2 to 8 s, each time elsewhere with
/// another motion, and away for 1 to 5 s. The same settings give the same run.
/// @param parts  of the mannequin
[[nodiscard]] AvatarSoakResult soakAvatars(const Decomposition& parts, const AvatarSoakSettings& settings);

}  // namespace lorica::bench
