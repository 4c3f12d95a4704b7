#pragma once

#include "capture/skeleton_frame.h"
#include "capture/tracking/fit/body_fit.h"
#include "capture/tracking/fit/calm_limbs.h"
#include "capture/tracking/fit/joint_confidence.h"
#include "capture/tracking/fit/limb_search.h"
#include "capture/tracking/fit/person_search.h"

#include <optional>

namespace lorica::fit {

/// Whether what is fitted is a person at all: furniture and two people at once are also given a pose, but the body
/// explains them badly, most of its parts are not seen, and it is as large as it may be. The limits are from recordings
/// of real people and rooms, see docs/TRACKING.md.
class BodyBelief {
 public:
  /// A view and the body fitted to it.
  struct Evidence {
    FitCost cost;
    CapsuleSupport support;
    float height = 0.0F;    ///< standing [m]
    bool moved = false;     ///< since it was found; furniture does not move
    bool attached = false;  ///< to the room, which the body need not explain
    bool part = false;      ///< only legs need be seen: the head is known, or it was said so
    bool waistUp = false;   ///< head and chest must be seen, and little else can be
  };
  void update(const Evidence& evidence);
  void forget() { *this = BodyBelief(); }

  [[nodiscard]] bool believed() const { return believed_; }

 private:
  bool believed_ = false;
  int trust_ = 0;  ///< views for it less views against it, limited
};

/// Tracks one person from view to view.
class PersonFit {
 public:
  /// Whether the hips, and all below them, are under the lower border of the image: to be told to the view.
  [[nodiscard]] bool isWaistUp(const BodyView& view) const;
  /// @param seconds  since the last view; ignored in the first
  /// @return whether there is a pose
  bool follow(const BodyView& view, float seconds);

  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] const BodyPose& pose() const { return pose_; }
  [[nodiscard]] const Proportions& proportions() const { return proportions_; }
  [[nodiscard]] const CapsuleSupport& support() const { return support_; }
  [[nodiscard]] const FitCost& cost() const { return cost_; }
  /// Standing height [m].
  [[nodiscard]] float height() const;
  [[nodiscard]] bool proportionsKnown() const { return views_ > 30; }

  /// The 15 joints with confidences, floor frame; time and user are left unchanged.
  void report(SkeletonFrame& frame) const;

  void forget();
  /// To be called when the floor frame changed.
  void move(const Eigen::Isometry3f& newFromOld);

 private:
  bool start(const BodyView& view);
  void resume(const BodyView& view);
  void reconsider(const BodyView& view);
  void searchLimbs(const BodyView& view);
  void challenge(const BodyView& view);
  void compareRival(const BodyView& view);
  void take(const Figure& figure);
  void holdLegs();
  void findUnseen(const BodyView& view);

  BodyFitter fitter_;
  LimbSearch limbs_;
  PersonSearch search_;
  bool started_ = false;
  int views_ = 0;              ///< since the person appeared
  int wholeViews_ = 0;         ///< those that showed the whole body
  int lost_ = 0;               ///< consecutive views not explained by the body
  float leastSeen_ = 0.0F;     ///< least area seen since the last search, if the image cut it off [m^2]
  V3 oldMiddle_ = V3::Zero();  ///< of the last view
  BodyPose pose_;
  Step velocity_ = Step::Zero();
  Proportions proportions_;
  CapsuleSupport support_;
  JointConfidence confidence_;
  CalmLimbs calm_;  ///< the pose that is reported
  FitCost cost_;
  float usualCost_ = 0.0F;  ///< of the image, recent average
  int turn_ = 0;            ///< limb to be searched for next
  int sincePair_ = 1;       ///< views since both legs were searched for again

  /// Another figure that may be the true one, tracked in parallel for some views.
  std::optional<Figure> rival_;
  int rivalViews_ = 0;
  float rivalCost_ = 0.0F, ownCost_ = 0.0F;  ///< sums over those views
  int sinceChallenge_ = 0;
  float startFacing_ = 0.0F;                    ///< see facingOf(), when this figure was taken; 0 = not known yet
  bool waistUp_ = false;                        ///< of the last view
  std::array<bool, kBodyJointCount> unseen_{};  ///< joints below the image, of whom it shows no more than the waist up
  bool headKnown_ = false;                      ///< outside the image, by a headset
  bool lowerBody_ = false;
  int wrongWay_ = 0;     ///< consecutive views in which the body faces away from where the headset looks
  bool urgent_ = false;  ///< the search in progress should end soon: the current estimate is not to be trusted
  bool fresh_ = false;   ///< the search in progress does not use the current estimate
};

}  // namespace lorica::fit
