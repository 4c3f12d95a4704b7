#pragma once

#include "capture/skeleton_frame.h"
#include "tracking/body_fit.h"
#include "tracking/joint_confidence.h"
#include "tracking/limb_search.h"

#include <array>
#include <optional>

namespace lorica::fit {

/// Follows one person from view to view.
class PersonFit {
 public:
  /// @param seconds  since the last view; at the first one ignored
  /// @return whether there is a pose
  bool follow(const BodyView& view, float seconds);

  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] const BodyPose& pose() const { return pose_; }
  [[nodiscard]] const Proportions& proportions() const { return proportions_; }
  [[nodiscard]] const CapsuleSupport& support() const { return support_; }
  [[nodiscard]] const FitCost& cost() const { return cost_; }
  /// Standing [m].
  [[nodiscard]] float height() const;
  [[nodiscard]] bool proportionsKnown() const { return views_ > 30; }

  /// The 15 joints with confidences, floor frame; time and user are left.
  void report(SkeletonFrame& frame) const;

  void forget();
  /// The floor frame moved.
  void move(const Eigen::Isometry3f& newFromOld);

 private:
  /// @param again  keeps the proportions and also tries where the person was
  bool start(const BodyView& view, bool again);
  void searchLimbs(const BodyView& view);
  bool tryLimb(const BodyView& view, Limb limb);
  void considerFacing(const BodyView& view);
  [[nodiscard]] PosePrior looseAround(const BodyPose& pose) const;

  struct Candidate {
    BodyPose pose;
    Proportions proportions;
    float cost;
  };

  BodyFitter fitter_;
  LimbSearch search_;
  bool started_ = false;
  int views_ = 0;
  int sinceStart_ = 0;
  int lost_ = 0;  ///< views in a row
  std::array<Candidate, 24> candidates_;
  std::size_t count_ = 0;
  BodyPose pose_, before_;
  Step velocity_ = Step::Zero();
  Proportions proportions_;
  CapsuleSupport support_;
  JointConfidence confidence_;
  FitCost cost_;

  // The figure that faces the other way, followed beside while it may be the true one.
  std::optional<BodyPose> other_;
  float doubt_ = 0.0F;  ///< how much better the other figure explains what was seen, summed over time
  int sinceOther_ = 0;
  std::array<float, kFitLimbCount> limbDoubt_{};
  int turn_ = 0;
};

}  // namespace lorica::fit
