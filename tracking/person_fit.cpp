#include "tracking/person_fit.h"

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

constexpr float kPi = 3.14159265F;
constexpr float kMannequinHeight = 1.752F;  ///< [m]
constexpr float kGapSeconds = 0.25F;        ///< after this long unseen the pose is found anew
constexpr float kLostShare = 0.20F;         ///< of points that the body does not explain: the person is lost
constexpr float kEase = 0.04F;              ///< of the way to rest, each view, by arms that are not seen
constexpr int kLostViews = 5;               ///< so many times in a row

constexpr std::array<FitStage, 3> kFollow = {{{0.15F, 150, 4}, {0.10F, 300, 3}, {0.06F, 600, 4}}};
constexpr std::array<FitStage, 2> kRough = {{{0.40F, 100, 4}, {0.20F, 150, 4}}};
constexpr std::array<FitStage, 2> kMedium = {{{0.15F, 200, 6}, {0.08F, 400, 6}}};
constexpr std::array<FitStage, 1> kLimb = {{{0.08F, 400, 4}}};
constexpr FitStage kJudge = {0.08F, 600, 0};

/// Deviation of each degree of freedom from what is predicted, in one frame.
Step followStiffness() {
  Step deviation;
  const auto& nodes = nodeDefs();
  for (std::size_t n = 0; n < kNodeCount; ++n) {
    float d = 0.35F;
    if (n == kPelvis) d = 0.20F;
    if (n == kSpine || n == kChest) d = 0.12F;
    if (n == kNeck) d = 0.20F;
    if (n == kLeftClavicle || n == kRightClavicle) d = 0.10F;
    if (n >= kLeftHand && n <= kRightHand) d = 0.25F;
    if (n >= kLeftFoot) d = 0.20F;
    for (int i = 0; i < nodes[n].dofCount; ++i) deviation[nodes[n].firstDof + i] = d;
  }
  deviation.head<3>().setConstant(0.08F);
  return deviation.cwiseAbs2().cwiseInverse();
}

/// An arm that is not seen most likely comes to hang.
void easeDown(Limb arm, BodyPose& pose) {
  static const BodyPose rest = standingPose(V3::Zero(), 0.0F, 0.15F, 0.1F, 0.25F);
  const Node up = upperNodeOf(arm), low = lowerNodeOf(arm), end = endNodeOf(arm);
  pose.turn[up] = pose.turn[up].slerp(kEase, rest.turn[up]);
  pose.angle[low][0] += kEase * (rest.angle[low][0] - pose.angle[low][0]);
  for (float& angle : pose.angle[end]) angle *= 1.0F - kEase;
}

PosePrior weakly(const BodyPose& pose, float stiffness) {
  PosePrior prior;
  prior.pose = pose;
  prior.stiffness.setConstant(stiffness);
  return prior;
}

}  // namespace

PosePrior PersonFit::looseAround(const BodyPose& pose) const {
  return weakly(pose, 0.5F);
}

float PersonFit::height() const {
  // Feet to crown of the body standing straight.
  PosedBody body;
  poseBody(BodyPose(), proportions_, body);
  const float sole = body.place[kLeftFoot].y() - 0.09F * body.girth[kLeftFoot];
  const float crown = placeIn(body, kNeck, {0.0F, kMannequinHeight, 0.0F}).y();
  return crown - sole;
}

void PersonFit::forget() {
  started_ = false;
  views_ = 0;
  other_.reset();
  velocity_.setZero();
  proportions_ = Proportions();
}

void PersonFit::move(const Eigen::Isometry3f& newFromOld) {
  const Q turn(newFromOld.linear());
  for (BodyPose* pose : {&pose_, &before_, other_ ? &*other_ : nullptr}) {
    if (!pose) continue;
    pose->root = newFromOld * pose->root;
    pose->turn[kPelvis] = turn * pose->turn[kPelvis];
  }
}

bool PersonFit::start(const BodyView& view, bool again) {
  const auto points = view.points();
  if (points.size() < 60) return false;
  float top = -1e9F;
  for (const BodyView::Point& point : points) top = std::max(top, point.place.y());
  const V3 away = V3(view.middle().x() - view.cameraPlace().x(), 0.0F, view.middle().z() - view.cameraPlace().z());
  const V3 back = away.normalized();
  const float towards = std::atan2(-back.x(), -back.z());
  const V3 middle = view.middle() + 0.10F * back;

  count_ = 0;
  const auto add = [&](const BodyPose& pose, const Proportions& proportions) {
    if (count_ < candidates_.size()) candidates_[count_++] = {pose, proportions, 0.0F};
  };
  Proportions standing = again ? proportions_ : Proportions();
  if (!again) standing.factor[kSize] = std::clamp(top / kMannequinHeight, 0.6F, 1.25F);
  Proportions usual = again ? proportions_ : Proportions();
  const float size = usual.factor[kSize];
  for (const float turn : {0.0F, kPi, 0.5F * kPi, -0.5F * kPi}) {
    const float heading = towards + turn;
    const V3 hips(middle.x(), top - (kMannequinHeight - 0.915F) * standing.factor[kSize], middle.z());
    const V3 seat(middle.x(), top - 0.80F * size, middle.z());
    add(standingPose(hips, heading, 0.15F, 0.0F, 0.2F), standing);
    add(standingPose(hips, heading, 1.4F, 0.0F, 0.2F), standing);
    add(standingPose(hips, heading, 0.2F, 0.8F, 1.2F), standing);
    if (top < 1.55F && top > 0.8F) add(sittingPose(seat, heading), usual);
    if (again) continue;
    // Children and comic figures: a large head.
    Proportions large = standing;
    large.factor[kSize] *= 0.86F;
    large.factor[kHeadSize] = 1.6F;
    const V3 low(middle.x(), 0.915F * large.factor[kSize], middle.z());
    add(standingPose(low, heading, 0.3F, 0.0F, 0.2F), large);
  }
  if (again) {
    add(pose_, proportions_);
    add(turnedAbout(pose_, proportions_), proportions_);
  }
  const auto byCost = [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; };
  for (std::size_t i = 0; i < count_; ++i) {
    Candidate& c = candidates_[i];
    c.cost = fitter_.fit(view, c.proportions, looseAround(c.pose), kRough, c.pose).plausible();
  }
  std::stable_sort(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(count_), byCost);
  count_ = std::min<std::size_t>(count_, 4);
  std::array<float, kProportionCount> deviation;
  deviation.fill(0.04F);
  for (std::size_t i = 0; i < count_; ++i) {
    Candidate& c = candidates_[i];
    pose_ = c.pose;
    proportions_ = c.proportions;
    fitter_.fit(view, proportions_, looseAround(pose_), kMedium, pose_);
    for (int round = 0; round < (again ? 0 : 5); ++round) {
      fitter_.refineProportions(view, deviation, pose_, proportions_);
      fitter_.fit(view, proportions_, looseAround(pose_), kLimb, pose_);
    }
    for (const Limb limb : {kLeftArm, kRightArm, kLeftLeg, kRightLeg}) tryLimb(view, limb);
    c.cost = fitter_.fit(view, proportions_, looseAround(pose_), kMedium, pose_).plausible();
    c.pose = pose_;
    c.proportions = proportions_;
  }
  const auto best =
      std::min_element(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(count_), byCost);
  pose_ = best->pose;
  proportions_ = best->proportions;
  before_ = pose_;
  velocity_.setZero();
  started_ = true;
  if (!again) views_ = 0;
  sinceStart_ = 0;
  confidence_.restart();
  doubt_ = 0.0F;
  other_.reset();
  return true;
}

bool PersonFit::tryLimb(const BodyView& view, Limb limb) {
  const auto candidates = search_.search(view, proportions_, pose_, limb);
  if (candidates.empty() || candidates[0].cost > search_.presentCost() - 10.0F) return false;
  const FitCost present = fitter_.costOf(view, proportions_, looseAround(pose_), kJudge, pose_);
  BodyPose best = pose_;
  float bestCost = present.plausible() - 6.0F;
  for (const LimbSearch::Candidate& candidate : candidates) {
    if (candidate.cost > search_.presentCost() - 5.0F) break;
    BodyPose pose = candidate.pose;
    fitter_.fit(view, proportions_, weakly(pose, 4.0F), kLimb, pose);
    const float cost = fitter_.costOf(view, proportions_, looseAround(pose), kJudge, pose).plausible();
    if (cost < bestCost) {
      bestCost = cost;
      best = pose;
    }
  }
  if (bestCost >= present.plausible() - 6.0F) return false;
  pose_ = best;
  return true;
}

void PersonFit::searchLimbs(const BodyView& view) {
  // Those that look lost, and one of the others in turn.
  turn_ = (turn_ + 1) % kFitLimbCount;
  for (int i = 0; i < kFitLimbCount; ++i) {
    const auto limb = static_cast<Limb>(i);
    float worst = 0.0F;
    for (std::size_t c = 0; c < kCapsuleCount; ++c) {
      if (!isOf(limb, capsuleDefs()[c].node)) continue;
      worst = std::max(worst, support_.violation[c]);
    }
    if (i == turn_ || worst > 0.06F) tryLimb(view, limb);
  }
}

void PersonFit::considerFacing(const BodyView& view) {
  (void)view;
}

bool PersonFit::follow(const BodyView& view, float seconds) {
  if (view.points().size() < 40) return false;
  if (!started_) {
    if (!start(view, false)) return false;
  } else if (seconds > kGapSeconds || (lost_ >= kLostViews && sinceStart_ >= kLostViews)) {
    start(view, true);
    lost_ = 0;
  }
  static const Step stiffness = followStiffness();
  PosePrior prior;
  prior.pose = stepped(pose_, 0.7F * velocity_);
  for (const Limb arm : {kLeftArm, kRightArm}) {
    if (confidence_.hidden(arm)) easeDown(arm, prior.pose);
  }
  prior.stiffness = stiffness;
  const BodyPose last = pose_;
  pose_ = prior.pose;
  cost_ = fitter_.fit(view, proportions_, prior, kFollow, pose_);
  support_ = fitter_.supportOf(view, proportions_, pose_);
  searchLimbs(view);
  considerFacing(view);
  ++views_;
  ++sinceStart_;
  std::array<float, kProportionCount> deviation;
  deviation.fill(views_ < 30 ? 0.01F : 0.001F);
  fitter_.refineProportions(view, deviation, pose_, proportions_);
  support_ = fitter_.supportOf(view, proportions_, pose_);
  confidence_.update(support_);
  lost_ = support_.unexplained > kLostShare ? lost_ + 1 : 0;
  velocity_ = stepBetween(last, pose_);
  for (int i = 0; i < kFitLimbCount; ++i) {
    const auto limb = static_cast<Limb>(i);
    if (!confidence_.hidden(i)) continue;
    for (const Node node : {upperNodeOf(limb), lowerNodeOf(limb), endNodeOf(limb)}) {
      velocity_.segment(nodeDefs()[node].firstDof, nodeDefs()[node].dofCount).setZero();
    }
  }
  const float fastest = velocity_.tail<kDofCount - 3>().cwiseAbs().maxCoeff();
  if (fastest > 0.5F) velocity_ *= 0.5F / fastest;
  before_ = last;
  return true;
}

void PersonFit::report(SkeletonFrame& frame) const {
  PosedBody body;
  poseBody(pose_, proportions_, body);
  readJoints(body, frame);
  for (std::size_t j = 0; j < frame.joints.size(); ++j) {
    frame.joints[j].confidence = confidence_[static_cast<BodyJoint>(j)];
  }
}

}  // namespace lorica::fit
