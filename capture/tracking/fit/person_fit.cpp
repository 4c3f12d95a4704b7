#include "capture/tracking/fit/person_fit.h"

#include "capture/tracking/fit/limb_pose.h"

#include <algorithm>

namespace lorica::fit {
namespace {

// Of belief.
constexpr float kMinSeen = 0.3F;      // share of a capsule that counts as seen
constexpr float kMaxHeight = 2.15F;   // of a person [m]
constexpr int kEnough = 3;            // views in favour until a person is believed
constexpr int kFull = 24;             // limit of the trust: so many views against a person end it
constexpr float kCertainCost = 1100;  // one view with this cost is enough
constexpr int kCertainSeen = 16;

/// The largest cost, and the number of capsules that must be seen, for a view to be in favour.
struct Limits {
  float cost;
  int seen;
};
constexpr Limits kStill = {1220.0F, 15};
constexpr Limits kMoved = {1800.0F, 9};
constexpr Limits kMovedAttached = {2300.0F, 15};
constexpr Limits kPart = {1800.0F, 6};
// From the waist up: less is seen, all of it near. Things with a head and shoulders of boxes cost 630 and more.
constexpr Limits kWaistUp = {560.0F, 5};
constexpr Limits kWaistUpMoved = {800.0F, 5};
constexpr float kAgainst = 1.15F;  // multiple of that cost from which a view is against a person believed before

int seenOf(const CapsuleSupport& support) {
  return std::ranges::count_if(support.seen, [](float share) { return share > kMinSeen; });
}

bool showsHeadAndChest(const CapsuleSupport& support) {
  bool head = false, chest = false;
  for (std::size_t c = 0; c < kCapsuleCount; ++c) {
    const bool seen = support.seen[c] > kMinSeen;
    head = head || (seen && capsuleDefs()[c].node == kNeck);
    chest = chest || (seen && capsuleDefs()[c].node == kChest);
  }
  return head && chest;
}

// Of the fit.
constexpr float kGapSeconds = 0.25F;  ///< after this long unseen the pose is searched for again
constexpr float kLostShare = 0.20F;   ///< fraction of points not explained by the body at which the person is lost
constexpr int kLostViews = 3;         ///< consecutive views
constexpr int kWrongViews = 5;        ///< in which the headset looks the other way until the person is turned about
constexpr float kPassing = 0.45F;     ///< feet closer than this may be swapped [m]
constexpr float kWorse = 1.25F;       ///< multiple of the usual cost at which a swap is checked
constexpr int kPairPause = 2;         ///< views between two such checks
constexpr float kUsualRise = 0.03F;   ///< how fast the usual cost follows the present one, per view
constexpr float kEase = 0.04F;        ///< fraction of the way to rest per view, for arms that are not seen
constexpr float kMomentum = 0.7F;     ///< fraction of the last step, in the prediction of the next

// How much a proportion may change in a view. Hardly at all later: in poses that the body explains badly, such as a
// deep squat, proportions drift to values that are wrong for all other poses.
constexpr int kLearningViews = 30;
constexpr float kLearning = 0.01F;
constexpr float kLearningCut = 0.001F;  // while the image has not shown the whole body for long enough
constexpr float kLearnt = 0.0005F;
constexpr int kLearntPause = 3;  // views between such small changes

constexpr int kEarlyViews = 60;      ///< during which rivals are searched for without pause
constexpr int kChallengePause = 60;  ///< views between later searches for rivals
constexpr int kRivalViews = 6;       ///< views that a rival is tracked before it can win
// Fraction of the present cost that a rival must stay below: in general, if it faces the other way, and the same at
// first, when people are taken to face the camera.
constexpr float kRivalShare = 0.93F;
constexpr float kTurnedShare = 0.80F;
constexpr float kTurnedAwayShare = 0.75F;
constexpr float kTurnedToCameraShare = 1.0F;
constexpr float kClearShare = 0.65F;  ///< a rival that costs less than this wins after kClearViews
constexpr int kClearViews = 2;
constexpr float kHopeless = 1.1F;      ///< a rival that costs more than this multiple of its limit is given up at once
constexpr float kStartEffort = 12.0F;  ///< milliseconds per view, approximately
constexpr float kEarlyEffort = 4.0F;
constexpr float kChallengeEffort = 2.0F;
constexpr double kInferred = 0.5;
constexpr std::size_t kMinPoints = 40;
constexpr float kMinArea = 0.08F;         ///< less shows no pose [m^2]
constexpr float kHipsUnderCrown = 0.84F;  ///< of an adult [m]
constexpr float kHipsBelow = 0.03F;       ///< whose hips are this far inside the image, shows them [m]
constexpr float kMuchMore = 1.6F;         ///< times as much seen of someone who enters: what was found is doubted

constexpr std::array<FitStage, 3> kFollow = {{{0.15F, 150, 4}, {0.10F, 300, 3}, {0.06F, 600, 4}}};
constexpr std::array<FitStage, 1> kRivalFollow = {{{0.08F, 400, 4}}};

/// Deviation of each degree of freedom from the prediction, in one frame.
Step followStiffness() {
  Step deviation;
  const auto& nodes = nodeDefs();
  for (std::size_t n = 0; n < kNodeCount; ++n) {
    float d = 0.35F;
    if (n == kPelvis) d = 0.20F;
    if (n == kSpine || n == kChest) d = 0.12F;
    if (n == kNeck) d = 0.20F;
    if (n == kLeftClavicle || n == kRightClavicle) d = 0.10F;
    if (n == kLeftHand || n == kRightHand) d = 0.25F;
    if (n == kLeftFoot || n == kRightFoot) d = 0.20F;
    for (int i = 0; i < nodes[n].dofCount; ++i) deviation[nodes[n].firstDof + i] = d;
  }
  deviation.head<3>().setConstant(0.08F);
  return deviation.cwiseAbs2().cwiseInverse();
}

/// An arm that is not seen most likely moves to hang down.
void easeDown(Limb arm, BodyPose& pose) {
  const BodyPose& rest = restPose();
  const Node up = upperNodeOf(arm), low = lowerNodeOf(arm), end = endNodeOf(arm);
  pose.turn[up] = pose.turn[up].slerp(kEase, rest.turn[up]);
  pose.angle[low][0] += kEase * (rest.angle[low][0] - pose.angle[low][0]);
  for (float& angle : pose.angle[end]) angle *= 1.0F - kEase;
}

}  // namespace

void BodyBelief::update(const Evidence& evidence) {
  const Limits& limits = evidence.part       ? kPart
                         : evidence.waistUp  ? (evidence.moved ? kWaistUpMoved : kWaistUp)
                         : !evidence.moved   ? kStill
                         : evidence.attached ? kMovedAttached
                                             : kMoved;
  // How far limbs are from rest says nothing: people sit, chairs stand.
  const float cost = evidence.cost.image() + evidence.cost.body;
  const int seen = seenOf(evidence.support);
  const bool possible = evidence.height < kMaxHeight && (!evidence.waistUp || showsHeadAndChest(evidence.support));
  if (believed_) {
    const bool against = !possible || cost > kAgainst * limits.cost;
    trust_ = std::min(kFull, trust_ + (against ? -1 : 1));
    believed_ = trust_ > 0;
    return;
  }
  const bool inFavour = possible && cost < limits.cost && seen >= limits.seen;
  trust_ = inFavour ? trust_ + 1 : 0;
  believed_ = trust_ >= kEnough || (inFavour && cost < kCertainCost && seen >= kCertainSeen);
  if (believed_) trust_ = kFull;
}

float PersonFit::height() const {
  // Sole to crown of the body standing straight.
  PosedModel body;
  poseBody(BodyPose(), proportions_, body);
  const float sole = body.position[kLeftFoot].y() - 0.09F * body.girth[kLeftFoot];
  const float crown = positionIn(body, kNeck, {0.0F, kMannequinHeight, 0.0F}).y();
  return crown - sole;
}

void PersonFit::forget() {
  started_ = false;
  views_ = 0;
  leastSeen_ = 0.0F;
  search_.stop();
  calm_.restart();
  urgent_ = false;
  rival_.reset();
  proportions_ = Proportions();
}

void PersonFit::move(const Eigen::Isometry3f& newFromOld) {
  const Q turn(newFromOld.linear());
  for (BodyPose* pose : {&pose_, rival_ ? &rival_->pose : nullptr}) {
    if (!pose) continue;
    pose->root = newFromOld * pose->root;
    pose->turn[kPelvis] = turn * pose->turn[kPelvis];
  }
  calm_.move(newFromOld);
}

void PersonFit::take(const Figure& figure) {
  pose_ = figure.pose;
  proportions_ = figure.proportions;
  velocity_.setZero();
  confidence_.restart();
  rival_.reset();
  lost_ = 0;
  startFacing_ = 0.0F;
}

bool PersonFit::isWaistUp(const BodyView& view) const {
  if (!view.cutBelow() || view.lowerBody() || view.headOutside()) return false;
  if (!started_) return !view.cutAbove() && view.top() - view.bottom() < kHipsUnderCrown;
  const V3 edge = pose_.root + V3(0.0F, waistUp_ ? -kHipsBelow : kHipsBelow, 0.0F);
  return !view.sightOf(edge).inside;
}

bool PersonFit::start(const BodyView& view) {
  if (!search_.busy()) search_.begin(view, std::nullopt);
  if (!search_.work(view, kStartEffort)) return false;
  take(search_.found());
  started_ = true;
  views_ = 0;
  wholeViews_ = 0;
  sinceChallenge_ = 0;
  return true;
}

void PersonFit::resume(const BodyView& view) {
  // The pose is old: move it to the person's present position, and search for another pose as well.
  pose_.root += V3(view.middle().x() - oldMiddle_.x(), 0.0F, view.middle().z() - oldMiddle_.z());
  velocity_.setZero();
  confidence_.restart();
  rival_.reset();
  search_.begin(view, Figure{pose_, proportions_});
  urgent_ = true;
  views_ = std::min(views_, kEarlyViews / 2);
}

/// What was found when only a part was seen may be wrong: someone who enters, or who at first stands behind something,
/// is searched for again, more and more of them.
void PersonFit::reconsider(const BodyView& view) {
  const float seen = view.seenArea();
  const bool partial = view.cut() || views_ < kEarlyViews;
  if (!partial && leastSeen_ == 0.0F) return;
  if (leastSeen_ == 0.0F || seen < leastSeen_) leastSeen_ = seen;
  if (seen < kMuchMore * leastSeen_) return;
  leastSeen_ = partial ? seen : 0.0F;
  search_.begin(view, proportionsKnown() ? Figure{pose_, proportions_} : std::optional<Figure>());
  rival_.reset();
  urgent_ = true;
  views_ = std::min(views_, kEarlyViews / 2);
}

void PersonFit::searchLimbs(const BodyView& view) {
  // Both arms in every view, each leg in every fourth.
  improveLimb(fitter_, limbs_, view, proportions_, kLeftArm, pose_);
  improveLimb(fitter_, limbs_, view, proportions_, kRightArm, pose_);
  if (view.waistUp()) return;
  turn_ = (turn_ + 1) % kFitLimbCount;
  if (turn_ > kRightArm) improveLimb(fitter_, limbs_, view, proportions_, static_cast<Limb>(turn_), pose_);
  // Legs that pass each other may have been swapped; the image is then explained worse than before.
  ++sincePair_;
  if (sincePair_ < kPairPause || cost_.image() < kWorse * usualCost_) return;
  PosedModel body;
  poseBody(pose_, proportions_, body);
  if ((body.position[kLeftFoot] - body.position[kRightFoot]).norm() > kPassing * proportions_.factor[kSize]) return;
  improvePair(fitter_, limbs_, view, proportions_, kLeftLeg, pose_);
  sincePair_ = 0;
}

void PersonFit::compareRival(const BodyView& view) {
  fitter_.fit(view, rival_->proportions, weakly(rival_->pose, 2.0F), kRivalFollow, rival_->pose);
  const auto judge = [&](const Figure& f) {
    return fitter_.costOf(view, f.proportions, weakly(f.pose, 0.0F), kJudge, f.pose).plausible();
  };
  rivalCost_ += judge(*rival_);
  ownCost_ += judge({pose_, proportions_});
  ++rivalViews_;
  const float facing = facingOf(view, rival_->pose);
  const bool rivalWrong = facingOfWorn(view, rival_->pose) < kWrongWay;
  const bool ownWrong = facingOfWorn(view, pose_) < kWrongWay;
  if (rivalWrong != ownWrong) {
    if (ownWrong) {
      take(*rival_);
    } else {
      rival_.reset();
    }
    return;
  }
  const bool turned = facing * facingOf(view, pose_) < 0.0F;
  const float turnedEarly = facing > 0.0F ? kTurnedToCameraShare : kTurnedAwayShare;
  // Whoever was seen to turn around is known to face away, even if little tells a front from a back.
  const bool turnedAround = view.waistUp() && startFacing_ * facingOf(view, pose_) < 0.0F;
  const float share = !turned ? kRivalShare : views_ < kEarlyViews && !turnedAround ? turnedEarly : kTurnedShare;
  if (rivalCost_ > kHopeless * share * ownCost_) {
    rival_.reset();
  } else if (rivalViews_ >= kRivalViews || (rivalViews_ >= kClearViews && rivalCost_ < kClearShare * ownCost_)) {
    if (rivalCost_ < share * ownCost_) {
      take(*rival_);
    } else {
      rival_.reset();
    }
  }
}

void PersonFit::challenge(const BodyView& view) {
  if (rival_) {
    compareRival(view);
    return;
  }
  ++sinceChallenge_;
  wrongWay_ = facingOfWorn(view, pose_) < kWrongWay ? wrongWay_ + 1 : 0;
  if (wrongWay_ >= kWrongViews && !search_.busy()) {
    search_.begin(view, Figure{pose_, proportions_});
    urgent_ = true;
  }
  const bool lost = lost_ >= kLostViews;
  if (!search_.busy()) {
    const int pause = lost ? 0 : (views_ < kEarlyViews ? 4 : kChallengePause);
    if (sinceChallenge_ < pause) return;
    // At first the proportions are uncertain too.
    fresh_ = views_ < 2 * kEarlyViews && !fresh_;
    search_.begin(view, fresh_ ? std::optional<Figure>() : Figure{pose_, proportions_});
  }
  if (!search_.work(view, lost || urgent_ ? kStartEffort : (views_ < kEarlyViews ? kEarlyEffort : kChallengeEffort)))
    return;
  sinceChallenge_ = 0;
  urgent_ = false;
  rival_ = search_.found();
  rivalViews_ = 0;
  rivalCost_ = 0.0F;
  ownCost_ = 0.0F;
}

bool PersonFit::follow(const BodyView& view, float seconds) {
  if (view.points().size() < kMinPoints || view.seenArea() < kMinArea) return false;
  if (!started_) {
    oldMiddle_ = view.middle();
    if (!start(view)) return false;
  } else if (seconds > kGapSeconds) {
    resume(view);
  }
  oldMiddle_ = view.middle();
  waistUp_ = view.waistUp();
  if (waistUp_) holdLegs();
  reconsider(view);
  static const Step stiffness = followStiffness();
  PosePrior prior;
  prior.pose = stepped(pose_, kMomentum * velocity_);
  for (int n = kLeftThigh; waistUp_ && n < kNodeCount; ++n) {
    prior.pose.turn[n] = pose_.turn[n];
    prior.pose.angle[n] = pose_.angle[n];
  }
  for (const Limb arm : {kLeftArm, kRightArm}) {
    if (confidence_.hidden(arm)) easeDown(arm, prior.pose);
  }
  prior.stiffness = stiffness;
  const BodyPose last = pose_;
  pose_ = prior.pose;
  cost_ = fitter_.fit(view, proportions_, prior, kFollow, pose_);
  support_ = fitter_.supportOf(view, proportions_, pose_);
  searchLimbs(view);
  usualCost_ = views_ == 0
                   ? cost_.image()
                   : usualCost_ + (cost_.image() < usualCost_ ? 0.3F : kUsualRise) * (cost_.image() - usualCost_);
  ++views_;
  wholeViews_ += view.cut() ? 0 : 1;
  const bool learning = wholeViews_ < kLearningViews;
  std::array<float, kProportionCount> deviation =
      deviations(view, urgent_ || view.attached()                             ? kLearnt
                       : views_ < kLearningViews || (learning && !view.cut()) ? kLearning
                       : learning                                             ? kLearningCut
                                                                              : kLearnt);
  if (view.blurred() && view.cut() && views_ < kLearningViews) {
    // A blurred outline is too wide, and hides where limbs end.
    deviation = deviations(view, kLearningCut);
    deviation[kTrunkGirth] = deviation[kLimbGirth] = kLearning;
  }
  if (views_ < kLearningViews || learning || views_ % kLearntPause == 0) {
    fitter_.refineProportions(view, deviation, pose_, proportions_);
  }
  support_ = fitter_.supportOf(view, proportions_, pose_);
  if (startFacing_ == 0.0F) startFacing_ = facingOf(view, pose_);
  confidence_.update(support_, view.attached());
  findUnseen(view);
  headKnown_ = view.headOutside();
  lowerBody_ = view.lowerBody();
  lost_ = support_.unexplained > kLostShare ? lost_ + 1 : 0;
  velocity_ = stepBetween(last, pose_);
  for (int i = 0; i < kFitLimbCount; ++i) {
    if (!confidence_.hidden(i)) continue;
    const auto limb = static_cast<Limb>(i);
    for (const Node node : {upperNodeOf(limb), lowerNodeOf(limb), endNodeOf(limb)}) {
      velocity_.segment(nodeDefs()[node].firstDof, nodeDefs()[node].dofCount).setZero();
    }
  }
  const float fastest = velocity_.tail<kDofCount - 3>().cwiseAbs().maxCoeff();
  if (fastest > 0.5F) velocity_ *= 0.5F / fastest;
  if (sincePair_ > 0) challenge(view);
  calm_.update(pose_, proportions_, confidence_, seconds);
  return true;
}

/// What is below the image is unseen, but the torso, which chest and head show.
void PersonFit::findUnseen(const BodyView& view) {
  unseen_.fill(false);
  if (!waistUp_) return;
  PosedModel body;
  poseBody(pose_, proportions_, body);
  SkeletonFrame frame;
  readJoints(body, frame);
  for (std::size_t j = 0; j < unseen_.size(); ++j) {
    unseen_[j] = !view.sightOf(frame.joints[j].position.cast<float>()).inside;
  }
  using J = BodyJoint;
  for (const J joint : {J::kLeftHip, J::kRightHip, J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) {
    unseen_[ordinalOf(joint)] = true;
  }
  for (const J joint : {J::kHead, J::kNeck, J::kTorso}) unseen_[ordinalOf(joint)] = false;
}

/// Legs that are not in the image stand or sit.
void PersonFit::holdLegs() {
  PosedModel body;
  poseBody(pose_, proportions_, body);
  layLegs(body, pose_.root.y() / proportions_.factor[kSize], pose_);
}

void PersonFit::report(SkeletonFrame& frame) const {
  PosedModel body;
  poseBody(calm_.pose(), proportions_, body);
  readJoints(body, frame);
  for (std::size_t j = 0; j < frame.joints.size(); ++j) {
    frame.joints[j].confidence = confidence_[static_cast<BodyJoint>(j)];
  }
  calm_.doubt(frame);
  for (std::size_t j = 0; j < unseen_.size(); ++j) {
    if (unseen_[j]) frame.joints[j].confidence = 0.0;
  }
  using J = BodyJoint;
  if (headKnown_) {  // between it and the legs little can be wrong
    for (const J joint : {J::kNeck, J::kTorso, J::kLeftHip, J::kRightHip, J::kLeftKnee, J::kRightKnee}) {
      frame[joint].confidence = std::max(frame[joint].confidence, kInferred);
    }
  }
  if (!lowerBody_) return;
  for (const J joint :
       {J::kLeftShoulder, J::kRightShoulder, J::kLeftElbow, J::kRightElbow, J::kLeftHand, J::kRightHand}) {
    frame[joint].confidence = 0.0;
  }
  if (!headKnown_) frame[J::kHead].confidence = frame[J::kNeck].confidence = 0.0;
}

}  // namespace lorica::fit
