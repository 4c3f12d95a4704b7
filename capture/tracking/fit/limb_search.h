#pragma once

#include "capture/tracking/fit/body_fit.h"
#include "capture/tracking/fit/limb_pose.h"

#include <array>
#include <vector>

namespace lorica::fit {

/// Finds possible poses of a limb regardless of its previous pose: tries a bank of poses and reaches for points that no
/// other part of the body explains.
class LimbSearch {
 public:
  LimbSearch();

  struct Candidate {
    BodyPose pose;
    float cost;  ///< of the limb alone; comparable within one search
  };
  /// @param pose     fixed except for the limb
  /// @param without  another limb to be ignored; the limb itself = none
  /// @return the best few candidates, best first, mutually different; valid until the next call
  std::span<const Candidate> search(const BodyView& view, const Proportions& proportions, const BodyPose& pose,
                                    Limb limb, Limb without);
  std::span<const Candidate> search(const BodyView& view, const Proportions& proportions, const BodyPose& pose,
                                    Limb limb) {
    return search(view, proportions, pose, limb, limb);
  }
  /// Cost of the limb as it is in the pose of the last search.
  [[nodiscard]] float presentCost() const { return presentCost_; }

 private:
  static constexpr int kMaxCandidates = 3;
  /// @param limit  the sum ends when it reaches this
  float costOf(const BodyView& view, const BodyPose& pose, const Proportions& proportions, Limb limb, float limit);
  void offer(const BodyPose& pose, float cost, Limb limb);

  struct Near {
    V3 position, normal, ray;
    float otherSq;     ///< squared distance from the rest of the body, robust [m^2]
    float otherBound;  ///< at least its root [m]
  };
  std::vector<Near> near_;
  std::vector<V3> loose_;
  PosedModel body_;
  Limb without_ = kLeftArm;
  std::array<Candidate, kMaxCandidates> candidates_;
  std::size_t count_ = 0;
  float presentCost_ = 0.0F;
};

}  // namespace lorica::fit
