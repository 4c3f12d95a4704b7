#pragma once

#include "acd/part_tree.h"
#include "acd/support.h"

#include <utility>
#include <vector>

namespace lorica {

/// Hull volumes of the halves into which planes would cut a part. Halves are given by a sketch of the part's tree.
class HalfVolumes {
 public:
  /// @param reduce  keep only the points on the hull of each node; no others can be on the hull of a half. Costs about
  ///                as much as scoring ten planes and makes scoring several times faster, with identical results
  HalfVolumes(const PartTree& tree, bool reduce);

  /// Volume of one half's hull in a keyframe [m^3].
  /// @param tolerance  see convexHullVolume
  [[nodiscard]] double above(const PartTree::Sketch& sketch, std::size_t keyframe, double tolerance) const;
  [[nodiscard]] double below(const PartTree::Sketch& sketch, std::size_t keyframe, double tolerance) const;

 private:
  [[nodiscard]] double volume(const PartTree::Half& half, const std::vector<CutPoint>& crossings, std::size_t keyframe,
                              double tolerance) const;

  const PartTree& tree_;
  std::vector<std::vector<std::int32_t>> hullPoints_;  // node x keyframe; empty if not reduced
};

/// The same volumes, estimated from extreme points: ten times faster and a few percent too small, by about the same
/// fraction for all planes through one part. Used to select the planes to score exactly.
class HalfEstimates {
 public:
  explicit HalfEstimates(const PartTree& tree);

  /// Estimated volumes of the hulls above and below, summed over all keyframes [m^3].
  [[nodiscard]] std::pair<double, double> volumes(const PartTree::Sketch& sketch) const;

 private:
  const PartTree& tree_;
  std::vector<FloatPoints> points_;  // for each keyframe, centred and scaled so that the part is roughly isotropic
  std::vector<double> scale_;        // factor from volumes there to actual volumes
  std::vector<Support> supports_;    // node x keyframe
};

}  // namespace lorica
