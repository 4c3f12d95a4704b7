#pragma once

#include "capture/tracking/body_fit.h"
#include "capture/tracking/limb_pose.h"

#include <array>
#include <vector>

namespace lorica::fit {

/// Finds where a limb could be, whatever it was before: tries a bank of poses and reaches for points that no other part
/// of the body explains.
class LimbSearch {
 public:
  LimbSearch();

  struct Candidate {
    BodyPose pose;
    float cost;  ///< of the limb alone; comparable within one search
  };
  /// @param pose     all but the limb is taken as it is
  /// @param without  another limb that is left out as if it were not there; the limb itself = none
  /// @return the best few candidates, best first, unlike each other; valid until the next call
  std::span<const Candidate> search(const BodyView& view, const Proportions& proportions, const BodyPose& pose,
                                    Limb limb, Limb without);
  std::span<const Candidate> search(const BodyView& view, const Proportions& proportions, const BodyPose& pose,
                                    Limb limb) {
    return search(view, proportions, pose, limb, limb);
  }
  /// Of the limb as it is in the pose of the last search.
  [[nodiscard]] float presentCost() const { return presentCost_; }

 private:
  static constexpr int kMostCandidates = 3;
  float costOf(const BodyView& view, const BodyPose& pose, const Proportions& proportions, Limb limb);
  void offer(const BodyPose& pose, float cost, Limb limb);

  struct Near {
    V3 place, normal, ray;
    float otherSq;  ///< squared distance from the rest of the body, robust [m^2]
  };
  std::vector<Near> near_;
  std::vector<V3> loose_;
  PosedBody body_;
  Limb without_ = kLeftArm;
  std::array<Candidate, kMostCandidates> candidates_;
  std::size_t count_ = 0;
  float presentCost_ = 0.0F;
};

}  // namespace lorica::fit
