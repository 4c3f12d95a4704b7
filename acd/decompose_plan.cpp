#include "acd/decompose_plan.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// For cuts of which most turn out to be useless.
SplitEffort quickEffort(SplitEffort effort) {
  effort.candidateEdges = 8;
  effort.planesPerEdge = 3;
  effort.axisPlanes = 4;
  effort.diagonalPlanes = 0;
  effort.refinedPlanes = std::min(effort.refinedPlanes, 1);
  effort.shortlist = 1;
  return effort;
}

}  // namespace

Plan planFor(const DecomposeSettings& settings) {
  Plan plan;
  switch (settings.preset) {
    case DecomposePreset::kPaper:
      break;
    case DecomposePreset::kFast:
      plan.cuts.effort.candidateEdges = 12;
      plan.cuts.effort.edgeSpacing = 0.05;
      plan.cuts.effort.axisPlanes = 6;
      plan.cuts.effort.diagonalPlanes = 6;
      plan.cuts.effort.refinedPlanes = 2;
      plan.cuts.effort.refineSteps = 8;
      plan.cuts.effort.refineBelow = 0.15;  // cuts through handles gain only by the next cut
      plan.cuts.effort.shortlist = 2;
      plan.cuts.effort.balance = 0.01;
      plan.cuts.effort.coarse = 1e-3;
      plan.cuts.effort.exactVolume = false;  // the next piece is not chosen by its gain
      plan.cuts.overCut = 1.4;
      plan.rounds = {{quickEffort(plan.cuts.effort), 4}};
      break;
    case DecomposePreset::kQuality:
      plan.cuts.effort.candidateEdges = 16;
      plan.cuts.effort.edgeSpacing = 0.05;
      plan.cuts.effort.axisPlanes = 12;
      plan.cuts.effort.refinedPlanes = 3;
      plan.cuts.effort.refineSteps = 8;
      plan.cuts.effort.shortlist = 4;
      plan.cuts.effort.balance = 0.03;
      plan.cuts.effort.coarse = 1e-3;
      plan.cuts.overCut = 1.7;
      plan.cuts.byGain = true;
      plan.rounds = {{quickEffort(plan.cuts.effort), 12}, {plan.cuts.effort, 8}};
      break;
  }
  if (settings.candidateEdges > 0) plan.cuts.effort.candidateEdges = settings.candidateEdges;
  if (settings.planesPerEdge > 0) plan.cuts.effort.planesPerEdge = settings.planesPerEdge;
  // Without part count and limits, cutting goes on until all parts are convex: nothing to merge or improve. One part
  // needs no cut.
  const bool toTheEnd =
      settings.maxParts == 0 && settings.maxError <= 0.0 && settings.maxDistance <= 0.0 && settings.maxConcavity <= 0.0;
  if (toTheEnd || settings.maxParts == 1) {
    plan.cuts.overCut = 1.0;
    plan.rounds.clear();
  }
  // Where limits are for single parts: of a ring every cut gains nothing, but its arcs can be cut further.
  const bool partsLimited = settings.maxDistance > 0.0 || settings.maxConcavity > 0.0;
  if (partsLimited && settings.preset != DecomposePreset::kPaper) {
    plan.cuts.effort.acrossBelow = 0.2;
    plan.cuts.fewerEffort = quickEffort(plan.cuts.effort);
    plan.cuts.fewerPatience = settings.preset == DecomposePreset::kQuality ? 2.0 : 1.0;
    if (settings.maxError <= 0.0) plan.cuts.overCutUpTo = 32;
  }
  // Planes that do not pass through concave edges would then cut off endlessly many small pieces.
  if (toTheEnd) {
    plan.cuts.effort.axisPlanes = plan.cuts.effort.diagonalPlanes = plan.cuts.effort.refinedPlanes = 0;
  }
  return plan;
}

std::vector<std::size_t> pieceCounts(int partCount, double overCut) {
  const std::size_t wanted = partCount;
  std::vector<std::size_t> counts = {wanted};
  if (overCut <= 1.0) return counts;
  // A fixed sequence of part counts, each 1.4 times the one before.
  for (std::size_t upTo = 1;; upTo = (7 * upTo + 4) / 5) {
    const std::size_t pieces = std::ceil(upTo * overCut);
    if (pieces > counts.back()) counts.push_back(pieces);
    if (upTo >= wanted) return counts;
  }
}

}  // namespace lorica
