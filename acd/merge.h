#pragma once

#include "acd/piece.h"

#include <span>
#include <vector>

namespace lorica {

/// Groups of pieces after merging, and the order in which they come apart again.
struct Merged {
  std::vector<std::vector<std::size_t>> groups;  ///< pieces of each part; part 0 .. partCount - 1
  std::vector<PartIndex> splitFrom;  ///< part i + 1 comes out of part splitFrom[i]: every prefix is a decomposition
};

/// Merges pieces two by two, always the pair whose common hull adds least volume over all keyframes, down to
/// `partCount` parts, then on to a single one to find the order of the levels of detail.
/// @param coarse  tolerance of the hulls while scoring, see convexHullVolume
[[nodiscard]] Merged mergePieces(std::span<const Workpiece> pieces, const Workshop& shop, int partCount, double coarse);

}  // namespace lorica
