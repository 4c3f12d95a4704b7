#pragma once

#include "acd/part_tree.h"
#include "acd/support.h"

#include <utility>
#include <vector>

namespace lorica {

/// Hull volumes of the halves into which planes would cut a part. Halves are named by a sketch of the part's tree.
class HalfVolumes {
 public:
  /// @param reduce  keep of every node's points only those on its hull, no other can lie on a half's: costs about as
  ///                much as scoring ten planes and makes each several times faster, without loss
  HalfVolumes(const PartTree& tree, bool reduce);

  /// Volume of one half's hull in a keyframe [m^3].
  /// @param tolerance  see convexHullVolume
  [[nodiscard]] double above(const PartTree::Sketch& sketch, std::size_t keyframe, double tolerance) const;
  [[nodiscard]] double below(const PartTree::Sketch& sketch, std::size_t keyframe, double tolerance) const;

 private:
  [[nodiscard]] double volume(const PartTree::Half& half, const std::vector<CutPoint>& crossings, std::size_t keyframe,
                              double tolerance) const;

  const PartTree& tree_;
  std::vector<std::vector<std::int32_t>> hullPoints_;  // node x keyframe; empty where not reduced
};

/// The same, estimated from extreme points: ten times faster and some percent small, by much the same share for all
/// planes across one part. Good for telling which planes are worth a closer look.
class HalfEstimates {
 public:
  explicit HalfEstimates(const PartTree& tree);

  /// Estimated volumes of the hulls above and below, summed over all keyframes [m^3].
  [[nodiscard]] std::pair<double, double> volumes(const PartTree::Sketch& sketch) const;

 private:
  const PartTree& tree_;
  std::vector<FloatPoints> points_;  // for each keyframe, moved and stretched so that the part is about round
  std::vector<double> scale_;        // by which a volume there shrank
  std::vector<Support> supports_;    // node x keyframe
};

}  // namespace lorica
