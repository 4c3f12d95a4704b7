#include "capture/tracking/fit/person_search.h"

#include "capture/tracking/fit/limb_pose.h"

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

constexpr float kPi = 3.14159265F;
constexpr float kUnusualWeight = 5.0F;  ///< of proportions that differ from the mannequin's
constexpr float kReachHeight = 2.15F;   ///< of the mannequin's raised hands [m]
constexpr float kHipHeight = 0.915F;    ///< [m]
constexpr float kCrown = 0.17F;         ///< height of the crown over the head joint [m]
constexpr float kHeld = 1e-4F;          ///< deviation of proportions that the view cannot show

constexpr float kAway = 0.4F;            ///< added share of the cost of a newcomer who faces away from the camera
constexpr float kAgainstHeadset = 4.0F;  ///< the same of one who faces away from where their headset looks

constexpr float kUnfitted = 100.0F;  ///< how much worse than the present pose one may be that is not yet fitted
constexpr std::array<FitStage, 2> kRough = {{{0.40F, 100, 4}, {0.20F, 150, 4}}};
constexpr std::array<FitStage, 2> kMedium = {{{0.15F, 200, 6}, {0.08F, 400, 6}}};
constexpr std::array<FitStage, 1> kClose = {{{0.08F, 400, 4}}};
constexpr std::array<FitStage, 1> kTrial = {{{0.08F, 200, 4}}};

// Cost of steps in milliseconds on a desktop core.
constexpr float kRoughEffort = 1.0F;
constexpr float kFinalEffort = 2.5F;

// Phases of a finalist: fit, refine proportions twice, four limbs, fit again.
constexpr int kLimbPhase = 3;
constexpr int kLastPhase = kLimbPhase + kFitLimbCount;

}  // namespace

PosePrior weakly(const BodyPose& pose, float stiffness) {
  PosePrior prior;
  prior.pose = pose;
  prior.stiffness.setConstant(stiffness);
  return prior;
}

float facingOf(const BodyView& view, const BodyPose& pose) {
  V3 front = pose.turn[kPelvis] * V3::UnitZ();
  V3 camera = view.cameraPosition() - pose.root;
  front.y() = camera.y() = 0.0F;
  return front.normalized().dot(camera.normalized());
}

float facingOfWorn(const BodyView& view, const BodyPose& pose) {
  if (!view.worn()) return 1.0F;
  V3 front = pose.turn[kPelvis] * V3::UnitZ();
  front.y() = 0.0F;
  return front.normalized().dot(view.worn()->ahead);
}

std::array<float, kProportionCount> deviations(const BodyView& view, float each) {
  std::array<float, kProportionCount> deviation;
  deviation.fill(each);
  if (!view.waistUp()) return deviation;
  for (const Proportion of : {kSize, kTrunkLength, kHipBreadth, kThighLength, kShinLength}) deviation[of] = kHeld;
  return deviation;
}

bool improveLimb(BodyFitter& fitter, LimbSearch& search, const BodyView& view, const Proportions& proportions,
                 Limb limb, BodyPose& pose) {
  const auto candidates = search.search(view, proportions, pose, limb);
  if (candidates.empty() || candidates[0].cost > search.presentCost() + kUnfitted) return false;
  const FitCost present = fitter.costOf(view, proportions, weakly(pose, 0.5F), kJudge, pose);
  BodyPose best = pose;
  float bestCost = present.plausible() - 6.0F;
  bool found = false;
  for (const LimbSearch::Candidate& candidate : candidates) {
    if (candidate.cost > search.presentCost() + kUnfitted) break;
    BodyPose tried = candidate.pose;
    fitter.fit(view, proportions, weakly(tried, 4.0F), kTrial, tried);
    const float cost = fitter.costOf(view, proportions, weakly(tried, 0.5F), kJudge, tried).plausible();
    if (cost >= bestCost) continue;
    bestCost = cost;
    best = tried;
    found = true;
  }
  if (found) pose = best;
  return found;
}

bool improvePair(BodyFitter& fitter, LimbSearch& search, const BodyView& view, const Proportions& proportions,
                 Limb left, BodyPose& pose) {
  const float best = fitter.costOf(view, proportions, weakly(pose, 0.5F), kJudge, pose).plausible() - 6.0F;
  const BodyPose present = pose;
  for (const int order : {0, 1}) {
    const auto first = static_cast<Limb>(left + order);
    const auto second = static_cast<Limb>(left + 1 - order);
    const auto one = search.search(view, proportions, present, first, second);
    if (one.empty()) continue;
    BodyPose tried = one[0].pose;
    const auto other = search.search(view, proportions, tried, second);
    if (other.empty()) continue;
    tried = other[0].pose;
    fitter.fit(view, proportions, weakly(tried, 4.0F), kClose, tried);
    const float cost = fitter.costOf(view, proportions, weakly(tried, 0.5F), kJudge, tried).plausible();
    if (cost >= best) continue;
    pose = tried;
    return true;
  }
  return false;
}

void PersonSearch::add(const BodyPose& pose, const Proportions& proportions) {
  if (count_ < kMax) candidates_[count_++] = {{pose, proportions}, 0.0F};
}

void PersonSearch::begin(const BodyView& view, const std::optional<Figure>& present) {
  count_ = 0;
  next_ = 0;
  phase_ = 0;
  rough_ = true;
  busy_ = true;
  newcomer_ = !present;
  middle_ = view.middle();
  float top = -1e9F;
  for (const BodyView::Point& point : view.points()) top = std::max(top, point.position.y());
  if (view.headOutside()) top = view.worn()->head.y() + kCrown;
  const V3 away(middle_.x() - view.cameraPosition().x(), 0.0F, middle_.z() - view.cameraPosition().z());
  const V3 back = away.normalized();
  const float towards = std::atan2(-back.x(), -back.z());
  const V3 position = middle_ + 0.10F * back;

  const auto sized = [&](float size) {
    Proportions proportions;
    proportions.factor[kSize] = std::clamp(size, 0.6F, 1.25F);
    return proportions;
  };
  // Without ground, the feet are out of sight: nothing is known about the size.
  const std::optional<float> ground = view.ground();
  const float tall = top - ground.value_or(0.0F);
  const Proportions standing = present ? present->proportions : sized(tall / kMannequinHeight);
  const Proportions usual = present ? present->proportions : Proportions();
  const Proportions reaching = present ? present->proportions : sized(tall / kReachHeight);
  // Children and cartoon figures: a large head.
  Proportions comic = sized(0.86F * tall / kMannequinHeight);
  comic.factor[kHeadSize] = 1.6F;
  if (present) {
    add(turnedAbout(present->pose, present->proportions), present->proportions);
    add(present->pose, present->proportions);
  }
  const auto hips = [&](float height) { return V3(position.x(), height, position.z()); };
  for (const float turn : {0.0F, kPi, 0.5F * kPi, -0.5F * kPi}) {
    const float heading = towards + turn;
    const float under = top - (kMannequinHeight - kHipHeight) * standing.factor[kSize];
    const float s = usual.factor[kSize];
    if (view.waistUp()) {
      // How tall they are cannot be seen: a standard body with its head, or raised hands, at the top.
      const V3 root = hips(view.top() - (kMannequinHeight - kHipHeight) * s);
      add(standingPose(root, heading, 0.15F, 0.2F, 0.4F), usual);
      add(standingPose(root, heading, 0.2F, 0.8F, 1.2F), usual);
      add(standingPose(root, heading, 0.3F, 0.5F, 2.3F), usual);
      add(standingPose(root, heading, 1.4F, 0.0F, 0.2F), usual);
      add(standingPose(hips(view.top() - (kReachHeight - kHipHeight) * s), heading, 2.8F, 0.0F, 0.2F), usual);
      continue;
    }
    if (ground && !(view.lowerBody() && !view.headOutside())) {
      add(standingPose(hips(under), heading, 0.15F, 0.0F, 0.2F), standing);
      add(standingPose(hips(under), heading, 1.4F, 0.0F, 0.2F), standing);
      add(standingPose(hips(under), heading, 0.2F, 0.8F, 1.2F), standing);
      if (tall > 1.2F) {
        add(standingPose(hips(*ground + kHipHeight * reaching.factor[kSize]), heading, 2.8F, 0.0F, 0.2F), reaching);
      }
      if (tall > 0.7F && tall < 1.55F) add(sittingPose(hips(top - 0.80F * s), heading), usual);
      add(standingPose(hips(*ground + kHipHeight * comic.factor[kSize]), heading, 0.3F, 0.0F, 0.2F), comic);
      if (present) {
        const Proportions other = sized(tall / kMannequinHeight);
        add(standingPose(hips(*ground + kHipHeight * other.factor[kSize]), heading, 0.15F, 0.0F, 0.2F), other);
      }
    }
    if (view.cut() || !ground) {
      // The feet or the head may be out of sight: a standard body with its head at the top, or with its feet on the
      // ground.
      add(standingPose(hips(top - 0.84F * s), heading, 0.15F, 0.2F, 0.4F), usual);
      if (ground) add(standingPose(hips(*ground + kHipHeight * s), heading, 0.15F, 0.2F, 0.4F), usual);
    }
  }
}

void PersonSearch::refine(const BodyView& view, Figure& figure, int phase) {
  if (phase == 0) {
    fitter_.fit(view, figure.proportions, weakly(figure.pose, 0.5F), kMedium, figure.pose);
    return;
  }
  if (phase < kLimbPhase) {
    const std::array<float, kProportionCount> deviation = deviations(view, view.attached() ? 0.01F : 0.04F);
    for (int round = 0; round < 2; ++round) {
      fitter_.refineProportions(view, deviation, figure.pose, figure.proportions);
      fitter_.fit(view, figure.proportions, weakly(figure.pose, 0.5F), kClose, figure.pose);
    }
    return;
  }
  if (phase < kLastPhase) {
    const auto limb = static_cast<Limb>(phase - kLimbPhase);
    if (view.waistUp() && isOfLeg(upperNodeOf(limb))) return;
    improveLimb(fitter_, limbs_, view, figure.proportions, limb, figure.pose);
    return;
  }
  fitter_.fit(view, figure.proportions, weakly(figure.pose, 0.5F), kMedium, figure.pose);
}

float PersonSearch::unusual(const Proportions& proportions) {
  float sum = 0.0F;
  for (std::size_t k = 0; k < kProportionCount; ++k) {
    const float usual = k == kSize || k == kHeadSize ? 0.15F : 0.08F;
    const float off = (proportions.factor[k] - 1.0F) / usual;
    sum += off * off;
  }
  return kUnusualWeight * sum;
}

float PersonSearch::judged(const BodyView& view, const Figure& figure, float plausible) const {
  const float away = newcomer_ && !view.worn() ? 0.5F * (1.0F - facingOf(view, figure.pose)) : 0.0F;
  const float wrong = facingOfWorn(view, figure.pose) < kWrongWay ? kAgainstHeadset : 0.0F;
  return (1.0F + kAway * away + wrong) * (plausible + unusual(figure.proportions));
}

void PersonSearch::pickFinalists(const BodyView& view) {
  if (count_ <= kFinal) return;
  const auto begin = candidates_.begin(), end = begin + count_;
  const auto finalists = begin + kFinal;
  const auto cheaper = [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; };
  for (auto position = begin; position != finalists; ++position)
    std::iter_swap(position, std::min_element(position, end, cheaper));
  // Some pay off only after fitting, so the best of them always becomes a finalist.
  const auto include = [&](const auto& belongs, auto place) {
    if (std::any_of(begin, finalists, belongs)) return;
    auto best = end;
    for (auto one = finalists; one != end; ++one) {
      if (belongs(*one) && (best == end || one->cost < best->cost)) best = one;
    }
    if (best != end) std::iter_swap(best, place);
  };
  const auto isComic = [](const Candidate& one) { return one.figure.proportions.factor[kHeadSize] > 1.3F; };
  const auto isUsual = [&](const Candidate& one) { return !isComic(one) && facingOf(view, one.figure.pose) > 0.5F; };
  include(isComic, finalists - 1);
  if (newcomer_) include(isUsual, isComic(*(finalists - 2)) ? finalists - 1 : finalists - 2);
  count_ = kFinal;
}

float PersonSearch::oneStep(const BodyView& view) {
  Candidate& c = candidates_[next_];
  if (rough_) {
    const FitCost cost = fitter_.fit(view, c.figure.proportions, weakly(c.figure.pose, 0.5F), kRough, c.figure.pose);
    c.cost = judged(view, c.figure, cost.plausible());
    if (++next_ < count_) return kRoughEffort;
    pickFinalists(view);
    next_ = 0;
    phase_ = 0;
    rough_ = false;
    return kRoughEffort;
  }
  refine(view, c.figure, phase_);
  if (++phase_ <= kLastPhase) return kFinalEffort;
  phase_ = 0;
  if (++next_ < count_) return kFinalEffort;
  // All in one view, so that they can be compared.
  best_ = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    Figure& figure = candidates_[i].figure;
    const FitCost cost = fitter_.fit(view, figure.proportions, weakly(figure.pose, 0.5F), kClose, figure.pose);
    candidates_[i].cost = judged(view, figure, cost.plausible());
    if (candidates_[i].cost < candidates_[best_].cost) best_ = i;
  }
  busy_ = false;
  return kFinalEffort;
}

bool PersonSearch::work(const BodyView& view, float effort) {
  if (!busy_) return true;
  // The candidates move with the person.
  const V3 by = view.middle() - middle_;
  middle_ = view.middle();
  for (std::size_t i = 0; i < count_; ++i) candidates_[i].figure.pose.root += by;
  while (busy_ && effort > 0.0F) effort -= oneStep(view);
  return !busy_;
}

}  // namespace lorica::fit
