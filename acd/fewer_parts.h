#pragma once

#include "acd/piece.h"
#include "acd/split_search.h"

#include <functional>
#include <memory>
#include <vector>

namespace lorica {

/// Makes two parts of three, again and again, as long as both are allowed: joins a part with two others that it touches
/// and cuts what they become once. Cuts halve: a round wall becomes sixteen parts where nine would do, and no two of
/// them can be merged.
/// @param patience  ends after this many attempts in a row that did not succeed
/// @param allowed   whether a part may be; it leaves Piece::excess
/// @param goOn      called before each attempt; return false to cancel
/// @return false if cancelled
[[nodiscard]] bool makeFewer(std::vector<std::shared_ptr<const Piece>>& parts, CutContext& context,
                             const SplitEffort& effort, double patience,
                             const std::function<bool(const Piece& part)>& allowed, const std::function<bool()>& goOn);

}  // namespace lorica
