#pragma once

#include "capture/skeleton_frame.h"
#include "capture/tracking/body_fit.h"
#include "capture/tracking/joint_confidence.h"
#include "capture/tracking/limb_search.h"
#include "capture/tracking/person_search.h"

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
  bool start(const BodyView& view);
  void resume(const BodyView& view);
  void searchLimbs(const BodyView& view);
  void challenge(const BodyView& view);
  void compareRival(const BodyView& view);
  void take(const Figure& figure);

  BodyFitter fitter_;
  LimbSearch limbs_;
  PersonSearch search_;
  bool started_ = false;
  int views_ = 0;              ///< followed since the person came
  int wholeViews_ = 0;         ///< of those, that showed all of the body
  int lost_ = 0;               ///< views in a row that the body does not explain
  V3 oldMiddle_ = V3::Zero();  ///< of the last view
  BodyPose pose_;
  Step velocity_ = Step::Zero();
  Proportions proportions_;
  CapsuleSupport support_;
  JointConfidence confidence_;
  FitCost cost_;
  float usualCost_ = 0.0F;  ///< of the image, of late
  int turn_ = 0;            ///< whose limb is searched for next
  int sincePair_ = 1;       ///< views since both legs were placed anew

  /// Another figure that may be the true one, followed beside for some views.
  std::optional<Figure> rival_;
  int rivalViews_ = 0;
  float rivalCost_ = 0.0F, ownCost_ = 0.0F;  ///< sums over those views
  int sinceChallenge_ = 0;
  bool fresh_ = false;  ///< the search under way asks nothing of what is believed
};

}  // namespace lorica::fit
