#include "capture/tracking/fit/joint_confidence.h"

#include <algorithm>
#include <initializer_list>

namespace lorica::fit {
namespace {

/// Names for the capsules of capsuleDefs(); names of paired ones are the left ones, each followed by the right one.
enum CapsuleName : std::uint8_t {
  kPelvisCapsule,
  kWaistCapsule,
  kChestCapsule,
  kNeckCapsule,
  kHeadCapsule,
  kClavicleCapsule,
  kUpperArmCapsule = 7,
  kForearmCapsule = 9,
  kHandCapsule = 11,
  kThighCapsule = 13,
  kCalfCapsule = 15,
  kShinCapsule = 17,
  kFootCapsule = 19,
};

constexpr double kRise = 0.2;  ///< max increase of confidence per view
constexpr double kMin = 0.1;   ///< of a joint without evidence
constexpr double kSeenFully = 2.0;
constexpr double kUnsure = 0.4;       ///< of what contradicts the image or may be something else
constexpr float kHiddenShare = 0.5F;  ///< of a capsule's samples behind something else, for it to count as hidden
constexpr float kHiddenSide = 0.3F;   ///< of the pelvis's edge on one side, for its place to be a guess

}  // namespace

void JointConfidence::restart() {
  confidence_.fill(kMin);
}

void JointConfidence::update(const CapsuleSupport& support, bool attached) {
  using J = BodyJoint;
  // 0.5 if as much of the capsule was seen as needed, 1 at twice that.
  const auto shown = [&](int capsule, double needed) {
    const std::size_t c = capsule;
    return std::clamp(static_cast<double>(support.seen[c]) / (kSeenFully * needed), 0.0, 1.0);
  };
  const auto violated = [&](int capsule, float max) { return support.violation[capsule] > max; };
  std::array<double, kBodyJointCount> now{};
  const auto set = [&](J joint, double value) { now[ordinalOf(joint)] = value; };
  set(J::kHead, shown(kHeadCapsule, 0.15));
  set(J::kNeck, std::max(shown(kNeckCapsule, 0.15), shown(kChestCapsule, 0.3)));
  set(J::kTorso, std::max({shown(kChestCapsule, 0.2), shown(kWaistCapsule, 0.2), shown(kPelvisCapsule, 0.2)}));
  for (const int side : {0, 1}) {
    const auto sideOf = [&](J left) { return static_cast<J>(static_cast<int>(left) + side); };
    const double upperArm = shown(kUpperArmCapsule + side, 0.6);
    const double forearm = shown(kForearmCapsule + side, 0.5);
    const double clavicle = shown(kClavicleCapsule + side, 0.25);
    double shoulder = std::max({clavicle, shown(kUpperArmCapsule + side, 0.4)});
    if (violated(kClavicleCapsule + side, 0.02F)) shoulder = std::min(shoulder, kUnsure);
    set(sideOf(J::kLeftShoulder), shoulder);
    double elbow = std::max(upperArm, forearm);
    if (violated(kUpperArmCapsule + side, 0.02F)) elbow = std::min(elbow, kUnsure);
    set(sideOf(J::kLeftElbow), elbow);
    double hand = std::max(shown(kHandCapsule + side, 0.45), shown(kForearmCapsule + side, 1.0));
    if (violated(kForearmCapsule + side, 0.015F) || violated(kHandCapsule + side, 0.025F))
      hand = std::min(hand, kUnsure);
    set(sideOf(J::kLeftHand), hand);
    set(sideOf(J::kLeftHip), std::max(shown(kPelvisCapsule, 0.4), shown(kThighCapsule + side, 0.3)));
    const double calf = std::max(shown(kCalfCapsule + side, 0.2), shown(kShinCapsule + side, 0.2));
    set(sideOf(J::kLeftKnee), std::max(calf, shown(kThighCapsule + side, 0.3)));
    set(sideOf(J::kLeftFoot), std::max(shown(kFootCapsule + side, 0.2), shown(kShinCapsule + side, 0.4)));
    const auto doubt = [&](std::initializer_list<J> leftJoints) {
      for (const J left : leftJoints) {
        double& joint = now[ordinalOf(sideOf(left))];
        joint = std::min(joint, kUnsure);
      }
    };
    // What is behind something else is a guess, whatever is seen of the parts beside it.
    const auto unsureBehind = [&](J left, std::initializer_list<int> capsules) {
      const auto isHidden = [&](int capsule) { return support.hidden[capsule + side] >= kHiddenShare; };
      if (std::ranges::all_of(capsules, isHidden)) doubt({left});
    };
    unsureBehind(J::kLeftElbow, {kUpperArmCapsule});
    unsureBehind(J::kLeftHand, {kForearmCapsule, kHandCapsule});
    unsureBehind(J::kLeftHip, {kThighCapsule});
    unsureBehind(J::kLeftKnee, {kThighCapsule});
    unsureBehind(J::kLeftKnee, {kCalfCapsule, kShinCapsule});
    unsureBehind(J::kLeftFoot, {kShinCapsule});
    // Where the trunk ends behind something else is not seen.
    if (support.hiddenSide[side] >= kHiddenSide) doubt({J::kLeftHip, J::kLeftKnee});
    // A seat beside the legs may be taken for them.
    if (attached) doubt({J::kLeftHip, J::kLeftKnee, J::kLeftFoot});
    const auto seen = [&](int capsule) { return support.seen[capsule + side]; };
    hidden_[side] = seen(kForearmCapsule) < 0.15F && seen(kHandCapsule) < 0.2F;
    hidden_[2 + side] = seen(kShinCapsule) < 0.15F && seen(kCalfCapsule) < 0.15F;
  }
  for (std::size_t j = 0; j < now.size(); ++j) {
    confidence_[j] = std::max(kMin, std::min(now[j], confidence_[j] + kRise));
  }
}

}  // namespace lorica::fit
