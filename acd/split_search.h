#pragma once

#include "acd/piece.h"

#include <optional>

namespace lorica {

/// How hard to look for the best split of a part.
struct SplitEffort {
  int candidateEdges = 8;    ///< C of the paper
  int planesPerEdge = 5;     ///< R of the paper
  double edgeSpacing = 0.0;  ///< candidate edges are at least this share of the part's diagonal apart
  int axisPlanes = 0;        ///< planes across each axis of the part
  int refineSteps = 0;       ///< halvings of the step of a search about the best planes
  int refinedPlanes = 0;     ///< how many of the best planes are refined
  int shortlist = 0;         ///< planes that are scored by hulls, the best by estimate; 0 = all
  double balance = 0.0;      ///< share of the part's error that halves of equal volume are worth
  double coarse = 1e-10;     ///< tolerance of the hulls while scoring, see convexHullVolume
};

/// A way to divide a part in two.
struct Split {
  Plane plane;
  std::size_t keyframe = 0;  ///< where the plane lies
  double hullVolume = 0.0;   ///< of both halves, summed over all keyframes [m^3]
};

/// The split that minimises the hull volume of both halves over all keyframes (Eq. 14; the meshes' volumes of both
/// halves add up to the part's, so they drop out). Ties go to the plane tried first, whatever the number of threads.
[[nodiscard]] std::optional<Split> bestSplit(const Workpiece& piece, std::size_t keyframe, const Workshop& shop,
                                             const SplitEffort& effort);

}  // namespace lorica
