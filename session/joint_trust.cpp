#include "session/joint_trust.h"

#include <algorithm>
#include <string_view>

namespace lorica {
namespace {

/// Confidences up to kGuessed give a trust of 0, from kSeen on a trust of 1.
constexpr double kGuessed = 0.5, kSeen = 0.8;
/// A faster joint is a tracking error: the fastest kicks are slower [m/s].
constexpr double kFastest = 20.0;
constexpr double kFadeSeconds = 0.3;
constexpr double kLongestStep = 0.1;  ///< [s]

using J = BodyJoint;

}  // namespace

std::optional<JointTrust::Source> JointTrust::sourceOf(HumanBone bone) {
  const std::string_view name = nameOf(bone);
  const auto has = [&](std::string_view part) { return name.find(part) != std::string_view::npos; };
  const bool left = name.starts_with("left"), right = name.starts_with("right");
  const auto side = [&](J leftOne, J rightOne) { return left ? leftOne : rightOne; };
  if (!left && !right) {
    if (bone == HumanBone::kNeck) return Source{J::kNeck, J::kNeck};
    if (bone == HumanBone::kHead) return Source{J::kHead, J::kHead};
    return Source{J::kTorso, J::kTorso};
  }
  const J shoulder = side(J::kLeftShoulder, J::kRightShoulder), elbow = side(J::kLeftElbow, J::kRightElbow);
  const J hand = side(J::kLeftHand, J::kRightHand), hip = side(J::kLeftHip, J::kRightHip);
  const J knee = side(J::kLeftKnee, J::kRightKnee), foot = side(J::kLeftFoot, J::kRightFoot);
  if (has("Shoulder")) return Source{shoulder, shoulder};
  if (has("UpperArm")) return Source{shoulder, elbow};
  if (has("LowerArm")) return Source{elbow, hand};
  if (has("UpperLeg")) return Source{hip, knee};
  if (has("LowerLeg")) return Source{knee, foot};
  if (has("Foot") || has("Toes")) return Source{foot, foot};
  return Source{hand, hand};  // the hand and its fingers
}

JointTrust::JointTrust(const Skeleton& skeleton) : joints_(skeleton.jointCount(), 1.0) {
  sources_.reserve(joints_.size());
  for (const Joint& joint : skeleton.joints()) {
    std::optional<Source> source;
    if (joint.bone) source = sourceOf(*joint.bone);
    if (!source && joint.parent != kNoJoint) source = sources_[joint.parent];
    sources_.push_back(source);
  }
}

void JointTrust::take(const SkeletonFrame& frame) {
  const double step = before_ ? std::clamp(frame.time - before_->time, 0.0, kLongestStep) : 0.0;
  for (std::size_t j = 0; j < tracked_.size(); ++j) {
    const TrackedJoint& joint = frame.joints[j];
    double wanted = std::clamp((joint.confidence - kGuessed) / (kSeen - kGuessed), 0.0, 1.0);
    if (before_ && joint.confidence > 0.0 && before_->joints[j].confidence > 0.0) {
      const double way = (joint.position - before_->joints[j].position).norm();
      if (!(way <= kFastest * std::max(step, 0.001))) wanted = 0.0;
    }
    // Trust is lost at once and recovers gradually; the first frame is trusted at once.
    tracked_[j] = before_ ? std::min(wanted, tracked_[j] + step / kFadeSeconds) : wanted;
  }
  before_ = frame;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (!sources_[j]) continue;
    const auto& [a, b] = *sources_[j];
    joints_[j] = std::min(tracked_[static_cast<std::size_t>(a)], tracked_[static_cast<std::size_t>(b)]);
  }
}

}  // namespace lorica
