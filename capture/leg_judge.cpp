#include "capture/leg_judge.h"

#include <algorithm>
#include <cmath>

namespace lorica {

namespace {

using J = BodyJoint;

constexpr double kMemory = 1.0;       // time constant of what is usual and of the share of bad frames [s]
constexpr double kFirstJudged = 0.5;  // no leg is judged before so much time has passed [s]
constexpr double kBadShare = 0.6;     // a leg is implausible from this share of bad frames on,
constexpr double kGoodShare = 0.25;   // and until it is below this one
constexpr double kLongestStep = 0.1;  // between frames; longer gaps count as this [s]
constexpr double kUpright = 0.8;      // cosine of the trunk's tilt up to which legs must hang down
constexpr double kInferred = 0.5;     // confidence up to which a joint is only inferred
// Change of a bone's length, relative to the usual one, that noise does not explain; of seen and of inferred joints.
constexpr double kSeenChange = 0.25;
constexpr double kInferredChange = 0.12;
// Thigh and shin relative to the trunk: 0.8 in adults.
constexpr double kShortest = 0.4;
constexpr double kLongest = 1.6;

[[nodiscard]] bool isSeen(const SkeletonFrame& frame, J joint) {
  return frame[joint].confidence > 0.0 && frame[joint].position.allFinite();
}

[[nodiscard]] bool differs(double length, double usual, double share) {
  return usual > 0.0 && std::abs(length - usual) > share * usual;
}

}  // namespace

/// One leg in one frame.
struct LegJudge::Look {
  bool seen = false;
  bool inverted = false;   ///< runs upwards from the hip
  bool stretched = false;  ///< a bone has an impossible length
};

void LegJudge::apply(SkeletonFrame& frame) {
  const double step = any_ ? std::clamp(frame.time - time_, 0.0, kLongestStep) : 0.0;
  const double share = any_ ? 1.0 - std::exp(-step / kMemory) : 1.0;
  time_ = frame.time;
  any_ = true;

  constexpr std::array<std::array<J, 3>, 2> kLegs = {
      {{J::kLeftHip, J::kLeftKnee, J::kLeftFoot}, {J::kRightHip, J::kRightKnee, J::kRightFoot}}};
  const bool hips = isSeen(frame, J::kLeftHip) && isSeen(frame, J::kRightHip);
  if (!hips || !isSeen(frame, J::kNeck)) return;
  const Vec3 trunk = frame[J::kNeck].position - 0.5 * (frame[J::kLeftHip].position + frame[J::kRightHip].position);
  const double trunkLength = trunk.norm();
  trunk_ += (trunk_ == 0.0 ? 1.0 : share) * (trunkLength - trunk_);
  const bool upright = trunk.y() > kUpright * trunkLength;
  judged_ += step;

  std::array<Look, 2> looks;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto& [hip, knee, foot] = kLegs[side];
    Look& look = looks[side];
    look.seen = isSeen(frame, knee) && isSeen(frame, foot);
    if (!look.seen) continue;
    Leg& leg = legs_[side];
    const Vec3& h = frame[hip].position;
    const Vec3& k = frame[knee].position;
    const Vec3& f = frame[foot].position;
    const double thigh = (k - h).norm();
    const double shin = (f - k).norm();
    const bool inferred = std::min(frame[knee].confidence, frame[foot].confidence) <= kInferred;
    const double change = inferred ? kInferredChange : kSeenChange;
    look.stretched = differs(thigh, leg.thigh, change) || differs(shin, leg.shin, change);
    for (const double length : {thigh, shin}) {
      look.stretched = look.stretched || length < kShortest * trunk_ || length > kLongest * trunk_;
    }
    const bool ankleHigh = f.y() > k.y() + 0.1 * shin;
    const bool kneeHigh = k.y() > h.y() + 0.1 * thigh && f.y() > h.y() - 0.2 * thigh;
    look.inverted = upright && (ankleHigh || kneeHigh);
    leg.thigh += (leg.thigh == 0.0 ? 1.0 : share) * (thigh - leg.thigh);
    leg.shin += (leg.shin == 0.0 ? 1.0 : share) * (shin - leg.shin);
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const Look& look = looks[side];
    const Look& other = looks[1 - side];
    Leg& leg = legs_[side];
    // One leg may be lifted high on purpose, while the other one stands.
    const bool bad = look.stretched || (look.inverted && (!other.seen || other.inverted || other.stretched));
    if (look.seen) leg.bad += share * ((bad ? 1.0 : 0.0) - leg.bad);
    if (judged_ >= kFirstJudged) leg.implausible = leg.bad > (leg.implausible ? kGoodShare : kBadShare);
    if (!leg.implausible) continue;
    ever_ = true;
    frame[kLegs[side][1]].confidence = 0.0;
    frame[kLegs[side][2]].confidence = 0.0;
  }
}

}  // namespace lorica
