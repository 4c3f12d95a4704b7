#pragma once

#include "acd/decompose.h"
#include "acd/improve.h"
#include "acd/split_search.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace lorica {

/// How pieces are cut.
struct CutPlan {
  SplitEffort effort;
  double overCut = 1.0;  ///< first cut into at least this multiple of the part count, then merge the cheapest pairs
  /// Pieces are cut further once they meet all limits, so that merging has alternatives; but not if more than this meet
  /// them: that takes long, and they hardly ever become fewer parts.
  std::size_t overCutUpTo = std::numeric_limits<std::size_t>::max();
  SplitEffort fewerEffort;     ///< of makeFewer()
  double fewerPatience = 0.0;  ///< of makeFewer(), as a multiple of the parts
  bool byGain = false;         ///< cut the part with the largest gain, not the one with the largest error

  /// How many pieces to cut at most, if so many are the first that meet all limits.
  [[nodiscard]] std::size_t piecesOnceMet(std::size_t met) const {
    return met <= overCutUpTo ? static_cast<std::size_t>(std::ceil(met * overCut)) : met;
  }
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
