#pragma once

#include "acd/split_search.h"

#include <functional>
#include <vector>

namespace lorica {

/// How a finished decomposition is improved.
struct ImproveRound {
  SplitEffort effort;
  int patience = 0;  ///< ends after this many consecutive unions were cut again without success
};

/// Improves a finished decomposition without changing the number of its parts: merges two parts and cuts the union
/// again, or a third one, as long as that saves hull volume.
/// @param goOn  called before each move; return false to cancel
/// @return false if cancelled
[[nodiscard]] bool improve(std::vector<Piece>& parts, CutContext& context, const ImproveRound& round,
                           const std::function<bool()>& goOn);

}  // namespace lorica
