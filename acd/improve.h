#pragma once

#include "acd/split_search.h"

#include <functional>
#include <vector>

namespace lorica {

/// Improves a finished decomposition without changing the number of its parts: joins two parts and cuts the union anew,
/// or joins two and cuts a third one, whatever saves most hull volume, until nothing saves much.
/// @param patience  unions that are cut anew without success before it stops
/// @param goOn      asked before each move; false cancels
/// @return false when cancelled
[[nodiscard]] bool improve(std::vector<Workpiece>& parts, Workshop& shop, const SplitEffort& effort, int patience,
                           const std::function<bool()>& goOn);

}  // namespace lorica
