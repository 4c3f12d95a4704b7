#pragma once

#include "capture/tracking/fit/body_fit.h"
#include "capture/tracking/fit/limb_search.h"

#include <array>
#include <optional>

namespace lorica::fit {

/// A pose and the proportions of the body.
struct Figure {
  BodyPose pose;
  Proportions proportions;
};

/// Searches for a person's pose and proportions without prior knowledge, a little in each view. It roughly fits figures
/// of several sizes, postures and headings, then fits the best ones closely, searching for each limb, and selects the
/// best.
class PersonSearch {
 public:
  /// Of whom the view shows no more than the waist up, the legs stay as they are in the candidates, standing.
  /// @param present  current estimate: tried too, also turned about; other candidates use its proportions. Without it,
  /// the person is a newcomer, who faces the camera unless the image clearly says otherwise
  void begin(const BodyView& view, const std::optional<Figure>& present);
  /// @param effort  about how many milliseconds to spend
  /// @return whether the search has finished
  bool work(const BodyView& view, float effort);
  void stop() { busy_ = false; }
  [[nodiscard]] bool busy() const { return busy_; }
  /// Once finished: as fitted to the last view.
  [[nodiscard]] const Figure& found() const { return candidates_[best_].figure; }

 private:
  struct Candidate {
    Figure figure;
    float cost = 0.0F;
  };
  static constexpr std::size_t kMax = 48;
  static constexpr std::size_t kFinal = 3;

  void add(const BodyPose& pose, const Proportions& proportions);
  [[nodiscard]] static float unusual(const Proportions& proportions);
  [[nodiscard]] float judged(const BodyView& view, const Figure& figure, float plausible) const;
  void pickFinalists(const BodyView& view);
  float oneStep(const BodyView& view);
  void refine(const BodyView& view, Figure& figure, int phase);

  BodyFitter fitter_;
  LimbSearch limbs_;
  std::array<Candidate, kMax> candidates_;
  std::size_t count_ = 0;
  std::size_t next_ = 0;
  int phase_ = 0;
  bool rough_ = true;
  bool busy_ = false;
  bool newcomer_ = false;
  std::size_t best_ = 0;
  V3 middle_ = V3::Zero();  ///< of the view that the candidates refer to
};

/// Tries other poses of a limb and takes one if it explains the view better.
/// @param pose  updated if the limb moved
bool improveLimb(BodyFitter& fitter, LimbSearch& search, const BodyView& view, const Proportions& proportions,
                 Limb limb, BodyPose& pose);

/// Searches for both arms, or both legs, again, one after the other in either order: limbs that pass each other may
/// have been swapped. The result is taken if it explains the view better.
/// @param left  kLeftArm or kLeftLeg
bool improvePair(BodyFitter& fitter, LimbSearch& search, const BodyView& view, const Proportions& proportions,
                 Limb left, BodyPose& pose);

/// Cosine of the angle, seen from above, between where a body faces and the direction to the camera: 1 = it faces the
/// camera.
[[nodiscard]] float facingOf(const BodyView& view, const BodyPose& pose);

/// The same to where a headset looks; a trunk turns less far away from the head than kWrongWay. 1 without a headset.
[[nodiscard]] float facingOfWorn(const BodyView& view, const BodyPose& pose);
inline constexpr float kWrongWay = -0.2F;

/// How far each proportion may move in a step, where the view can show it: of whom it shows no more than the waist up,
/// the size of the body stays an adult's, or what it was.
[[nodiscard]] std::array<float, kProportionCount> deviations(const BodyView& view, float each);

/// The stage at which figures are compared.
inline constexpr FitStage kJudge = {0.08F, 600, 0};
/// A weak prior that only holds what nothing else constrains.
[[nodiscard]] PosePrior weakly(const BodyPose& pose, float stiffness);

}  // namespace lorica::fit
