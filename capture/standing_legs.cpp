#include "capture/standing_legs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

using J = BodyJoint;

constexpr std::array<std::array<J, 3>, 2> kLegs = {
    {{J::kLeftHip, J::kLeftKnee, J::kLeftFoot}, {J::kRightHip, J::kRightKnee, J::kRightFoot}}};

constexpr double kLongestStep = 0.1;  // between frames; longer gaps count as this [s]

// Of legs that are judged.
constexpr double kMemory = 1.0;       // time constant of what is usual and of the share of bad frames [s]
constexpr double kFirstJudged = 0.5;  // no leg is judged before so much time has passed [s]
constexpr double kBadShare = 0.6;     // a leg is implausible from this share of bad frames on,
constexpr double kGoodShare = 0.25;   // and until it is below this one
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

// Of legs to stand on.
constexpr double kBlend = 0.5;         // time in which these legs appear or go [s]
constexpr double kUnknownFor = 0.7;    // legs that are lost for less are held by the retargeter [s]
constexpr double kUsualSeconds = 2.0;  // time constant of the usual height of the hips [s]
constexpr double kTrunkSeconds = 1.0;
constexpr double kUsualTrunk = 0.5;  // until one is seen [m]
// Lengths in trunks.
constexpr double kThigh = 0.82;
constexpr double kShin = 0.80;
constexpr double kAnkle = 0.15;      // height of the ankle
constexpr double kStraight = 0.985;  // of the legs' length while standing
constexpr double kReach = 0.35;      // a foot steps when it is farther from its place
constexpr double kLift = 0.12;       // height of a step
constexpr double kLowest = 0.9;      // the hips sink at most by this
constexpr double kTurn = 0.7;        // a foot steps when the body has turned farther [rad]
constexpr double kStepSeconds = 0.35;
constexpr double kConfidence = 0.5;  // inferred

[[nodiscard]] bool isKnown(const SkeletonFrame& frame, std::size_t side) {
  return isSeen(frame, kLegs[side][0]) && isSeen(frame, kLegs[side][1]) && isSeen(frame, kLegs[side][2]);
}

/// The person's left, level; from the hips, else the shoulders.
[[nodiscard]] Vec3 leftOf(const SkeletonFrame& frame) {
  for (const auto& [left, right] : {std::pair(J::kLeftHip, J::kRightHip), {J::kLeftShoulder, J::kRightShoulder}}) {
    if (!isSeen(frame, left) || !isSeen(frame, right)) continue;
    Vec3 line = frame[left].position - frame[right].position;
    line.y() = 0.0;
    if (line.norm() > 0.02) return line.normalized();
  }
  return Vec3::UnitX();
}

[[nodiscard]] double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

[[nodiscard]] double smooth(double t) {
  return t * t * (3.0 - 2.0 * t);
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

constexpr double StandingLegs::kHipHeight = kStraight * (kThigh + kShin) + kAnkle;

Vec3 StandingLegs::Foot::position() const {
  return from + smooth(stepped) * (to - from);
}

void StandingLegs::apply(SkeletonFrame& frame) {
  const double step = any_ ? std::clamp(frame.time - time_, 0.0, kLongestStep) : 0.0;
  time_ = frame.time;
  const bool always = use_ != Use::kIfUnknown;
  const bool known = !always && (isKnown(frame, 0) || isKnown(frame, 1));
  unknown_ = known ? 0.0 : unknown_ + step;
  const bool wanted = always || (!known && unknown_ >= kUnknownFor);
  if (!any_ && always) share_ = 1.0;
  any_ = true;
  const double change = step / kBlend;
  share_ = wanted ? std::min(1.0, share_ + change) : std::max(0.0, share_ - change);
  if (share_ <= 0.0) {
    placed_ = false;
    return;
  }
  if (isSeen(frame, J::kNeck)) stand(frame, step);
}

void StandingLegs::stand(SkeletonFrame& frame, double step) {
  // 1. The trunk; hips that are not seen hang below the neck.
  const bool hipsSeen = isSeen(frame, J::kLeftHip) && isSeen(frame, J::kRightHip);
  const Vec3 neck = frame[J::kNeck].position;
  if (hipsSeen) {
    const double length = (neck - 0.5 * (frame[J::kLeftHip].position + frame[J::kRightHip].position)).norm();
    trunk_ += (trunk_ == 0.0 ? 1.0 : 1.0 - std::exp(-step / kTrunkSeconds)) * (length - trunk_);
  }
  const double trunk = trunk_ > 0.1 ? trunk_ : kUsualTrunk;
  const Vec3 left = leftOf(frame);
  const Vec3 forward = left.cross(Vec3::UnitY());
  const double yaw = std::atan2(forward.x(), forward.z());
  const Vec3 middle = hipsSeen ? Vec3(0.5 * (frame[J::kLeftHip].position + frame[J::kRightHip].position))
                               : Vec3(neck - trunk * Vec3::UnitY());

  // 2. The height: slow movements of the hips are taken for the sensor's or the chair's, quick ones for the person's.
  if (!placed_) usualHips_ = middle.y();
  const double above = middle.y() - usualHips_;
  usualHips_ += (1.0 - std::exp(-step / kUsualSeconds)) * above;
  const double height = kHipHeight * trunk + std::clamp(above, -kLowest * trunk, 0.0);
  const double raise = use_ == Use::kOnKnownFloor ? 0.0 : share_ * (height - middle.y());
  for (TrackedJoint& joint : frame.joints) {
    if (joint.confidence > 0.0) joint.position.y() += raise;
  }
  const Vec3 hips(middle.x(), middle.y() + raise, middle.z());

  // 3. The feet: one steps at a time, the one that is farther from its place first.
  std::array<Vec3, 2> places;
  for (std::size_t side = 0; side < 2; ++side) {
    places[side] = hips + (side == 0 ? 1.0 : -1.0) * kHipHalf * trunk * left;
    places[side].y() = kAnkle * trunk;
    Foot& foot = feet_[side];
    if (!placed_) foot = {places[side], places[side], 1.0, yaw};
    foot.stepped = std::min(1.0, foot.stepped + step / kStepSeconds);
  }
  placed_ = true;
  const auto away = [&](std::size_t side) {
    return (feet_[side].to - places[side]).norm() / (kReach * trunk) + std::abs(wrapped(yaw - feet_[side].yaw)) / kTurn;
  };
  if (feet_[0].stepped >= 1.0 && feet_[1].stepped >= 1.0) {
    const std::size_t side = away(0) >= away(1) ? 0 : 1;
    if (away(side) > 1.0) feet_[side] = {feet_[side].to, places[side], 0.0, yaw};
  }

  // 4. The joints. The knee bends forward, by the law of cosines.
  for (std::size_t side = 0; side < 2; ++side) {
    const auto& [hipJoint, kneeJoint, footJoint] = kLegs[side];
    const Vec3 hip = hips + (side == 0 ? 1.0 : -1.0) * kHipHalf * trunk * left;
    Vec3 foot = feet_[side].position();
    foot.y() += kLift * trunk * std::sin(std::numbers::pi * feet_[side].stepped);
    const Vec3 leg = foot - hip;
    const double length = std::clamp(leg.norm(), 1e-3, (kThigh + kShin) * trunk);
    const Vec3 down = leg.normalized();
    foot = hip + length * down;
    const double thigh = kThigh * trunk;
    const double shin = kShin * trunk;
    const double along = (thigh * thigh - shin * shin + length * length) / (2.0 * length);
    const double out = std::sqrt(std::max(0.0, thigh * thigh - along * along));
    const Vec3 bend = (forward - forward.dot(down) * down).stableNormalized();
    const std::array<std::pair<J, Vec3>, 3> made = {
        {{hipJoint, hip}, {kneeJoint, Vec3(hip + along * down + out * bend)}, {footJoint, foot}}};
    for (const auto& [name, position] : made) {
      TrackedJoint& joint = frame[name];
      const bool own = joint.confidence > 0.0;
      if (name == hipJoint && own && hipsSeen) continue;  // the hips' own turn and tilt
      joint.position = own ? Vec3(joint.position + share_ * (position - joint.position)) : position;
      joint.orientation.reset();
      joint.confidence = std::max(joint.confidence, kConfidence);
    }
  }
}

}  // namespace lorica
