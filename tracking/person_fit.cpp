#include "tracking/person_fit.h"

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

constexpr float kPi = 3.14159265F;
constexpr float kMannequinHeight = 1.752F;  ///< [m]

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

bool PersonFit::start(const BodyView& view) {
  const auto points = view.points();
  if (points.size() < 60) return false;
  float top = -1e9F;
  float bottom = 1e9F;
  for (const BodyView::Point& point : points) {
    top = std::max(top, point.place.y());
    bottom = std::min(bottom, point.place.y());
  }
  const V3 away = V3(view.middle().x() - view.cameraPlace().x(), 0.0F, view.middle().z() - view.cameraPlace().z());
  const V3 back = away.normalized();
  const float towards = std::atan2(-back.x(), -back.z());
  proportions_ = Proportions();
  const bool upright = top > 1.35F && top < 2.15F;
  if (upright) proportions_.factor[kSize] = std::clamp(top / kMannequinHeight, 0.8F, 1.2F);
  const float size = proportions_.factor[kSize];

  struct Tried {
    BodyPose pose;
    float cost;
  };
  std::array<Tried, 20> tried;
  std::size_t count = 0;
  const V3 middle = view.middle() + 0.10F * back;
  for (const float turn : {0.0F, kPi, 0.5F * kPi, -0.5F * kPi}) {
    const float heading = towards + turn;
    const V3 standing(middle.x(), upright ? 0.915F * size : std::min(0.915F, top - 0.83F), middle.z());
    const V3 sitting(middle.x(), top - 0.80F * size, middle.z());
    tried[count++].pose = standingPose(standing, heading, 0.15F, 0.0F, 0.2F);
    tried[count++].pose = standingPose(standing, heading, 1.4F, 0.0F, 0.2F);
    tried[count++].pose = standingPose(standing, heading, 0.2F, 0.8F, 1.2F);
    if (top < 1.55F) tried[count++].pose = sittingPose(sitting, heading);
  }
  for (std::size_t i = 0; i < count; ++i) {
    tried[i].cost = fitter_.fit(view, proportions_, looseAround(tried[i].pose), kRough, tried[i].pose).plausible();
  }
  std::stable_sort(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(count),
                   [](const Tried& a, const Tried& b) { return a.cost < b.cost; });
  count = std::min<std::size_t>(count, 4);
  for (std::size_t i = 0; i < count; ++i) {
    pose_ = tried[i].pose;
    fitter_.fit(view, proportions_, looseAround(pose_), kMedium, pose_);
    for (const Limb limb : {kLeftArm, kRightArm, kLeftLeg, kRightLeg}) tryLimb(view, limb);
    tried[i].cost = fitter_.fit(view, proportions_, looseAround(pose_), kMedium, pose_).plausible();
    tried[i].pose = pose_;
  }
  const auto best = std::min_element(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(count),
                                     [](const Tried& a, const Tried& b) { return a.cost < b.cost; });
  pose_ = best->pose;
  before_ = pose_;
  velocity_.setZero();
  started_ = true;
  views_ = 0;
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
  (void)seconds;
  if (!started_ && !start(view)) return false;
  static const Step stiffness = followStiffness();
  PosePrior prior;
  prior.pose = stepped(pose_, 0.7F * velocity_);
  prior.stiffness = stiffness;
  const BodyPose last = pose_;
  pose_ = prior.pose;
  cost_ = fitter_.fit(view, proportions_, prior, kFollow, pose_);
  support_ = fitter_.supportOf(view, proportions_, pose_);
  searchLimbs(view);
  considerFacing(view);
  ++views_;
  std::array<float, kProportionCount> deviation;
  deviation.fill(views_ < 30 ? 0.01F : 0.001F);
  fitter_.refineProportions(view, deviation, pose_, proportions_);
  support_ = fitter_.supportOf(view, proportions_, pose_);
  velocity_ = stepBetween(last, pose_);
  const float fastest = velocity_.tail<kDofCount - 3>().cwiseAbs().maxCoeff();
  if (fastest > 0.5F) velocity_ *= 0.5F / fastest;
  before_ = last;
  return true;
}

void PersonFit::report(SkeletonFrame& frame) const {
  PosedBody body;
  poseBody(pose_, proportions_, body);
  readJoints(body, frame);
  for (TrackedJoint& joint : frame.joints) joint.confidence = 1.0;
}

}  // namespace lorica::fit
