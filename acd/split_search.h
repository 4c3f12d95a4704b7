#pragma once

#include "acd/piece.h"

#include <limits>
#include <optional>

namespace lorica {

/// Effort of the search for the best split of a part.
struct SplitEffort {
  int candidateEdges = 8;    ///< C of the paper
  int planesPerEdge = 5;     ///< R of the paper
  double edgeSpacing = 0.0;  ///< minimum distance of candidate edges, as a fraction of the part's diagonal
  int axisPlanes = 0;        ///< planes perpendicular to each axis of the mesh's frame and of the part
  int diagonalPlanes = 0;    ///< planes perpendicular to each diagonal between the axes of the mesh's frame
  int refineSteps = 0;       ///< steps of the local search around the best planes
  int refinedPlanes = 0;     ///< number of best planes that are refined
  double refineBelow = 1.0;  ///< refine only if the best plane gains less than this share of the part's error
  double acrossBelow = 0.0;  ///< if the best plane gains less than this share of the error: across the longest axis
  int shortlist = 0;         ///< number of planes, the best by estimate, that are scored exactly; 0 = all
  double balance = 0.0;      ///< weight of equal half volumes, as a fraction of the part's error
  double coarse = 1e-10;     ///< tolerance of the hulls while scoring, see convexHullVolume()
  bool exactVolume = true;   ///< whether Split::hullVolume is exact; otherwise it has the tolerance `coarse`
};

/// A way to divide a part in two.
struct Split {
  Plane plane;
  std::size_t keyframe = 0;  ///< keyframe of the plane
  double hullVolume = 0.0;   ///< of both halves, summed over all keyframes [m^3]
  bool across = false;       ///< chosen by SplitEffort::acrossBelow
};

/// Returns the split that minimizes the hull volume of both halves over all keyframes (Eq. 14; the mesh volumes of both
/// halves add up to the part's and cancel). In a tie the plane tried first wins, for any number of threads.
/// @param toBeat  a split with certainly no less hull volume than this may be left out [m^3]
[[nodiscard]] std::optional<Split> bestSplit(const Piece& piece, std::size_t keyframe, const CutContext& context,
                                             const SplitEffort& effort,
                                             double toBeat = std::numeric_limits<double>::infinity());

}  // namespace lorica
