#pragma once

#include "capture/tracking/body_fit.h"
#include "capture/tracking/limb_search.h"

#include <array>
#include <optional>

namespace lorica::fit {

/// A pose and the body that takes it.
struct Figure {
  BodyPose pose;
  Proportions proportions;
};

/// Looks for a person's pose and proportions from nothing, a little in each view: it fits figures of several sizes,
/// postures and headings roughly, the best of them closely with each limb searched for, and names the best.
class PersonSearch {
 public:
  /// @param present  what is believed so far: turned about, it is tried too, and others with its proportions
  void begin(const BodyView& view, const std::optional<Figure>& present);
  /// @param effort  about how many milliseconds to spend
  /// @return whether the search has ended
  bool work(const BodyView& view, float effort);
  void stop() { busy_ = false; }
  [[nodiscard]] bool busy() const { return busy_; }
  /// After the end: as fitted to the last view.
  [[nodiscard]] const Figure& found() const { return candidates_[best_].figure; }

 private:
  struct Candidate {
    Figure figure;
    float cost = 0.0F;
  };
  static constexpr std::size_t kMost = 48;
  static constexpr std::size_t kFinal = 3;

  void add(const BodyPose& pose, const Proportions& proportions);
  [[nodiscard]] static float unusual(const Proportions& proportions);
  void pickFinalists();
  float oneStep(const BodyView& view);
  void refine(const BodyView& view, Figure& figure, int phase);

  BodyFitter fitter_;
  LimbSearch limbs_;
  std::array<Candidate, kMost> candidates_;
  std::size_t count_ = 0;
  std::size_t next_ = 0;
  int phase_ = 0;
  bool rough_ = true;
  bool busy_ = false;
  std::size_t best_ = 0;
  V3 middle_ = V3::Zero();  ///< of the view that the candidates stand in
};

/// Tries other places for a limb and takes one if it explains the view better.
/// @param pose  written where the limb moved
bool improveLimb(BodyFitter& fitter, LimbSearch& search, const BodyView& view, const Proportions& proportions,
                 Limb limb, BodyPose& pose);

/// Places both arms, or both legs, anew, one after the other in either order: limbs that pass each other may have been
/// exchanged. Takes that if it explains the view better.
/// @param left  kLeftArm or kLeftLeg
bool improvePair(BodyFitter& fitter, LimbSearch& search, const BodyView& view, const Proportions& proportions,
                 Limb left, BodyPose& pose);

/// The stage at which figures are compared.
inline constexpr FitStage kJudge = {0.08F, 600, 0};
/// A prior that only keeps what nothing else holds where it is.
[[nodiscard]] PosePrior weakly(const BodyPose& pose, float stiffness);

}  // namespace lorica::fit
