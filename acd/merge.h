#pragma once

#include "acd/piece.h"

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace lorica {

/// Groups of pieces after merging, in level-of-detail order.
struct Merged {
  std::vector<std::vector<std::size_t>> groups;  ///< pieces of each part, for parts 0 .. partCount - 1
  std::vector<PartIndex> splitFrom;  ///< part i + 1 is split from part splitFrom[i]: every prefix is a decomposition
};

/// Repeatedly merges the pair of pieces whose common hull adds the least volume over all keyframes, down to `partCount`
/// parts, then continues to a single part to find the order of the levels of detail. Of equal pairs the one whose
/// pieces come first is merged. The pieces of a group are in ascending order.
/// @param pieces     at least one; if there are at most `partCount`, each is a part
/// @param partCount  at least 1
/// @param coarse     tolerance of the hulls while scoring, see convexHullVolume()
[[nodiscard]] Merged mergePieces(std::span<const std::shared_ptr<const Piece>> pieces, const CutContext& context,
                                 int partCount, double coarse);

/// Merges parts whose common hull is no larger than theirs together, in every keyframe: such a cut is of no use. The
/// cheapest pair is merged first; of equal pairs the first.
/// @param splitFrom  of the parts, see Decomposition, and stays such; or empty
/// @param allowed    whether a common part may be
void mergeForFree(std::vector<std::shared_ptr<const Piece>>& parts, std::vector<PartIndex>& splitFrom,
                  const CutContext& context, const std::function<bool(const Piece& common)>& allowed);

/// Merges touching parts as long as what they become is allowed, those whose hull grows least first.
/// @param maxEmpty  a common part whose hull has more empty volume than this in any keyframe is not allowed [m^3]
void mergeWithin(std::vector<std::shared_ptr<const Piece>>& parts, std::vector<PartIndex>& splitFrom,
                 const CutContext& context, double maxEmpty, const std::function<bool(const Piece& common)>& allowed);

}  // namespace lorica
