#pragma once

#include "acd/split_search.h"

#include <functional>
#include <vector>

namespace lorica {

/// Improves a finished decomposition without changing the number of its parts: merges two parts and cuts a third one,
/// or merges two parts and cuts the union again, as long as that saves hull volume.
/// @param patience  stops after this many consecutive unions were cut again without success
/// @param goOn      called before each move; return false to cancel
/// @return false if cancelled
[[nodiscard]] bool improve(std::vector<Piece>& parts, CutContext& context, const SplitEffort& effort, int patience,
                           const std::function<bool()>& goOn);

}  // namespace lorica
