#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <string>
#include <vector>

namespace lorica::bench {

/// Two people who do something together: their joints over time at 30 Hz, world frame, the camera at +Z.
struct Meeting {
  std::string name;
  std::array<std::vector<SkeletonFrame>, 2> people;  ///< the first starts at -X and faces +X, the second faces -X
};

/// Shaking hands, boxing, hugging, and changing places: 4 s each.
[[nodiscard]] std::vector<Meeting> meetings();

}  // namespace lorica::bench
