#pragma once

#include "acd/decompose.h"
#include "acd/improve.h"
#include "acd/split_search.h"

#include <cstddef>
#include <vector>

namespace lorica {

/// How pieces are cut.
struct CutPlan {
  SplitEffort effort;
  double overCut = 1.0;  ///< first cut into at least this multiple of the part count, then merge the cheapest pairs
  bool byGain = false;   ///< cut the part with the largest gain, not the one with the largest error
};

/// What a preset does.
struct Plan {
  CutPlan cuts;
  std::vector<ImproveRound> rounds;  ///< of improve(), after merging
};
[[nodiscard]] Plan planFor(const DecomposeSettings& settings);

/// Numbers of pieces, ascending, from which merging down to `partCount` parts is tried; the last one is the number to
/// cut. Larger part counts try every number that is large enough for them among those that smaller ones try, so more
/// parts are not worse.
[[nodiscard]] std::vector<std::size_t> pieceCounts(int partCount, double overCut);

}  // namespace lorica
