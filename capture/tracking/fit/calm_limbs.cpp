#include "capture/tracking/fit/calm_limbs.h"

#include <algorithm>
#include <span>
#include <utility>

namespace lorica::fit {
namespace {

constexpr float kGuessed = 3.0F;       ///< fastest movement of a limb that is not seen well, against its trunk [m/s]
constexpr float kSeen = 3.5F;          ///< the same of one that is seen well, from rest or shown elsewhere [m/s]
constexpr float kFaster = 100.0F;      ///< by which one that is seen well may become faster [m/s^2]
constexpr float kTrunk = 2.5F;         ///< fastest movement of head and trunk from rest [m/s]
constexpr float kTrunkFaster = 50.0F;  ///< by which they may become faster [m/s^2]
constexpr float kArrived = 0.03F;      ///< a limb shown this near to where it was fitted is there [m]
constexpr double kTrusted = 0.5;       ///< confidence of joints that are seen well
constexpr double kDoubted = 0.4;       ///< confidence of joints that are shown elsewhere
constexpr int kRounds = 5;             ///< of bounding a movement
constexpr float kLongPause = 0.25F;    ///< after which nothing is known of the last pose [s]

constexpr std::array<std::pair<BodyJoint, BodyJoint>, kFitLimbCount> kJointsOf = {
    {{BodyJoint::kLeftElbow, BodyJoint::kLeftHand},
     {BodyJoint::kRightElbow, BodyJoint::kRightHand},
     {BodyJoint::kLeftKnee, BodyJoint::kLeftFoot},
     {BodyJoint::kRightKnee, BodyJoint::kRightFoot}}};

constexpr std::array kTrunkNodes = {kPelvis, kSpine, kChest, kNeck, kLeftClavicle, kRightClavicle};

/// The largest distance of head, shoulders and hips in two poses [m].
float trunkApart(const PosedModel& a, const PosedModel& b) {
  float most = (headOf(b) - headOf(a)).norm();
  for (const Node node : {kLeftUpperArm, kRightUpperArm, kLeftThigh, kRightThigh}) {
    most = std::max(most, (b.position[node] - a.position[node]).norm());
  }
  return most;
}

/// The larger distance of a limb's two joints in two poses, as seen from its upper end [m].
float apart(Limb limb, const PosedModel& a, const PosedModel& b) {
  const V3 moved = b.position[upperNodeOf(limb)] - a.position[upperNodeOf(limb)];
  const auto moveOf = [&](Node node) { return (b.position[node] - a.position[node] - moved).norm(); };
  return std::max(moveOf(lowerNodeOf(limb)), moveOf(endNodeOf(limb)));
}

/// Lays nodes between two poses: at 0 as in one, at 1 as in the other.
void blend(std::span<const Node> nodes, const BodyPose& from, const BodyPose& to, float way, BodyPose& pose) {
  for (const Node node : nodes) {
    pose.turn[node] = from.turn[node].slerp(way, to.turn[node]);
    for (std::size_t k = 0; k < 2; ++k) {
      pose.angle[node][k] = from.angle[node][k] + way * (to.angle[node][k] - from.angle[node][k]);
    }
  }
}

}  // namespace

void CalmLimbs::move(const Eigen::Isometry3f& newFromOld) {
  if (!started_) return;
  shown_.root = newFromOld * shown_.root;
  shown_.turn[kPelvis] = Q(newFromOld.linear()) * shown_.turn[kPelvis];
  for (std::size_t n = 0; n < kNodeCount; ++n) {
    last_.position[n] = newFromOld * last_.position[n];
    last_.rotation[n] = newFromOld.linear() * last_.rotation[n];
  }
}

void CalmLimbs::update(const BodyPose& pose, const Proportions& proportions, const JointConfidence& confidence,
                       float seconds) {
  const BodyPose from = shown_;
  shown_ = pose;
  poseBody(pose, proportions, fitted_);
  const bool continues = started_ && seconds > 0.0F && seconds <= kLongPause;
  if (continues) {
    const float reach = std::max(kTrunk, trunkSpeed_ + kTrunkFaster * seconds) * seconds;
    float way = 1.0F;
    for (int round = 0; round < kRounds; ++round) {
      const float away = trunkApart(last_, fitted_);
      if (away <= reach) break;
      way *= reach / away;
      shown_.root = from.root + way * (pose.root - from.root);
      blend(kTrunkNodes, from, pose, way, shown_);
      poseBody(shown_, proportions, fitted_);
    }
  }
  trunkSpeed_ = continues ? trunkApart(last_, fitted_) / seconds : 0.0F;
  for (std::size_t i = 0; i < kJointsOf.size(); ++i) {
    const auto limb = static_cast<Limb>(i);
    const bool wasSure = sure_[i];
    sure_[i] = confidence[kJointsOf[i].first] >= kTrusted && confidence[kJointsOf[i].second] >= kTrusted;
    // Nothing stops at once because it is not seen any more.
    const float faster = sure_[i] && wasSure && !behind_[i] ? kFaster * seconds : 0.0F;
    const float reach = std::max(sure_[i] ? kSeen : kGuessed, speed_[i] + faster) * seconds;
    behind_[i] = false;
    speed_[i] = 0.0F;
    if (!continues) continue;
    float way = 1.0F;
    next_ = fitted_;
    const Node upper = upperNodeOf(limb);
    BodyPose still = from;  // the upper part points where it did, however the trunk turned
    still.turn[upper] = Q(M3(fitted_.rotation[nodeDefs()[upper].parent].transpose() * last_.rotation[upper]));
    // Several times, since joints move along arcs.
    for (int round = 0; round < kRounds; ++round) {
      const float away = apart(limb, last_, next_);
      if (away <= reach) break;
      way *= reach / away;
      blend(std::array{upper, lowerNodeOf(limb), endNodeOf(limb)}, still, pose, way, shown_);
      poseBody(shown_, proportions, next_);
    }
    speed_[i] = apart(limb, last_, next_) / seconds;
    behind_[i] = apart(limb, next_, fitted_) > kArrived;
  }
  started_ = true;
  poseBody(shown_, proportions, last_);
}

void CalmLimbs::doubt(SkeletonFrame& frame) const {
  for (std::size_t i = 0; i < kJointsOf.size(); ++i) {
    if (!behind_[i]) continue;
    for (const BodyJoint joint : {kJointsOf[i].first, kJointsOf[i].second}) {
      frame[joint].confidence = std::min(frame[joint].confidence, kDoubted);
    }
  }
}

}  // namespace lorica::fit
