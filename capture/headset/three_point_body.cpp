#include "capture/headset/three_point_body.h"

#include "capture/registration/head_registration.h"
#include "geometry/clock.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

constexpr double kStep = 1e-3;  // between frames that show the same [s]

class ThreePointJoints final : public SkeletonSource {
 public:
  explicit ThreePointJoints(std::shared_ptr<const WornHeadset> headset) : headset_(std::move(headset)) {
    frame_.user = kNobody;
  }

  Result<std::optional<SkeletonFrame>> next() override {
    const std::optional<HeadAndHands> newest = headset_->newest();
    if (newest && (frame_.user == kNobody || newest->time > frame_.time)) {
      frame_ = body_.follow(*newest);
    } else {
      frame_.time = std::max(frame_.time + kStep, now());
    }
    return std::optional(frame_);
  }

 private:
  std::shared_ptr<const WornHeadset> headset_;
  ThreePointBody body_;
  SkeletonFrame frame_;
};

using J = BodyJoint;

constexpr double kLowestEyes = 0.9, kHighestEyes = 2.1;  // of somebody who stands [m]
constexpr double kLongestStep = 0.1;                     // between poses; longer gaps count as this [s]
constexpr double kInferred = 0.5;                        // confidence
// Lengths in heights of the person.
constexpr double kEyes = 0.936;
constexpr double kNeck = 0.062;  // from the head joint down
constexpr double kShoulderHalf = 0.105;
constexpr double kShouldersBelowNeck = 0.012;
constexpr double kUpperArm = 0.186, kForearm = 0.196;  // to the palm
constexpr double kShrug = 0.05;                        // how far a shoulder follows the hand
constexpr double kHangs = 0.93;                        // of the arm's length, while the hand is not seen
constexpr double kLongestReach = 1.15;
// Time constants [s].
constexpr double kGrows = 0.5, kReaches = 0.5, kTurns = 0.2, kLeans = 0.12, kElbowTurns = 0.05;
constexpr double kHandComes = 0.3;  // and goes [s]
constexpr double kFarHands = 0.5;   // from the neck, level: they turn the chest as far as they can [m]
constexpr double kHandsTurn = 0.5;  // share of it
constexpr double kMostTurn = 1.2;   // of the chest, from where the head looks [rad]
constexpr double kLooksAhead = 0.2, kLooksDown = 0.9;  // a trunk leans between these pitches of the head [rad]
constexpr double kNods = 0.015;                        // the head sinks so far without the trunk [m]
constexpr double kMostLean = 1.4;                      // [rad]

/// Of a value that follows another one with a time constant.
double share(double step, double seconds) {
  return 1.0 - std::exp(-step / seconds);
}
double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}
Vec3 levelAt(double yaw) {
  return {std::sin(yaw), 0.0, std::cos(yaw)};
}

/// tposeFromGrip: the palms face down, the thumbs forward.
Mat3 tposeFromGrip(std::size_t side) {
  Mat3 axes;
  const double left = side == 0 ? 1.0 : -1.0;
  axes << 0.0, -left, 0.0,  //
      -left, 0.0, 0.0,      //
      0.0, 0.0, -1.0;
  return axes;
}

constexpr std::array<std::array<J, 3>, 2> kArms = {
    {{J::kLeftShoulder, J::kLeftElbow, J::kLeftHand}, {J::kRightShoulder, J::kRightElbow, J::kRightHand}}};

}  // namespace

std::unique_ptr<SkeletonSource> makeThreePointJoints(std::shared_ptr<const WornHeadset> headset) {
  return std::make_unique<ThreePointJoints>(std::move(headset));
}

SkeletonFrame ThreePointBody::follow(const HeadAndHands& known) {
  const bool first = eyeHeight_ == 0.0;
  const double step = first ? 0.0 : std::clamp(known.time - time_, 0.0, kLongestStep);
  time_ = known.time;
  SkeletonFrame frame;
  frame.time = known.time;

  // 1. Head and neck, and the height.
  const Vec3 up = Vec3::UnitY();
  const Mat3 turned = known.head.linear();
  const Vec3 head = known.head * kNominalHeadInHeadset;
  const double eyes = std::clamp(head.y() - kNominalHeadInHeadset.y(), kLowestEyes, kHighestEyes);
  if (first) eyeHeight_ = eyes;
  eyeHeight_ += share(step, kGrows) * std::max(0.0, eyes - eyeHeight_);
  const double height = eyeHeight_ / kEyes;
  const Vec3 neck = head - kNeck * height * (turned.col(1) + 1.5 * up).normalized();
  const double standing = eyeHeight_ + kNominalHeadInHeadset.y() - kNeck * height;  // height of the neck
  const double trunk = standing / (1.0 + StandingLegs::kHipHeight);

  // 2. The chest turns with the head, and with hands that are far from it.
  const Vec3 ahead = up.cross(turned.col(0));
  const double headYaw = std::atan2(ahead.x(), ahead.z());
  Vec3 hands = Vec3::Zero();
  for (const std::optional<Isometry3>& hand : known.hands) {
    if (hand) hands += 0.5 * (hand->translation() - neck);
  }
  const double far = std::min(std::hypot(hands.x(), hands.z()) / kFarHands, 1.0);
  const double aside = std::clamp(wrapped(std::atan2(hands.x(), hands.z()) - headYaw), -kMostTurn, kMostTurn);
  const double wanted = far > 0.0 ? kHandsTurn * far * aside : 0.0;
  if (first) yaw_ = headYaw + wanted;
  const double off = wrapped(yaw_ - headYaw);
  yaw_ = headYaw + std::clamp(off + share(step, kTurns) * wrapped(wanted - off), -kMostTurn, kMostTurn);

  // 3. The trunk leans if the person looks down to where the head went; else the knees bend.
  const double pitch = std::asin(std::clamp(turned.col(2).y(), -1.0, 1.0));
  const double down = std::clamp((pitch - kLooksAhead) / (kLooksDown - kLooksAhead), 0.0, 1.0);
  const double sunk = std::max(0.0, standing - neck.y() - kNods);
  const double leans = std::min(std::acos(std::max(1.0 - down * sunk / trunk, -1.0)), kMostLean);
  lean_ = first ? leans : lean_ + share(step, kLeans) * (leans - lean_);
  const Vec3 left = levelAt(yaw_ + 0.5 * std::numbers::pi);
  const Vec3 upright = std::cos(lean_) * up + std::sin(lean_) * levelAt(yaw_);
  const Vec3 hips = neck - trunk * upright;

  Isometry3 worldFromChest = Isometry3::Identity();
  worldFromChest.linear() << left, upright, left.cross(upright);
  worldFromChest.translation() = neck - kShouldersBelowNeck * height * upright;
  const auto turn = [](const Mat3& rotation) { return Quat(rotation).normalized(); };
  frame[J::kHead] = {head, turn(turned * Eigen::AngleAxisd(std::numbers::pi, up).toRotationMatrix()), 1.0};
  frame[J::kNeck] = {neck, std::nullopt, kInferred};
  frame[J::kTorso] = {0.5 * (neck + hips), turn(worldFromChest.linear()), kInferred};
  frame[J::kLeftHip] = {hips + StandingLegs::kHipHalf * trunk * left, std::nullopt, kInferred};
  frame[J::kRightHip] = {hips - StandingLegs::kHipHalf * trunk * left, std::nullopt, kInferred};

  // 4. Arms and legs.
  for (std::size_t side = 0; side < 2; ++side) bendArm(side, known, worldFromChest, step, frame);
  legs_.apply(frame);
  return frame;
}

void ThreePointBody::bendArm(std::size_t side, const HeadAndHands& known, const Isometry3& worldFromChest, double step,
                             SkeletonFrame& frame) {
  Arm& arm = arms_[side];
  const bool first = arm.bend.isZero();
  const double height = eyeHeight_ / kEyes, out = side == 0 ? 1.0 : -1.0;
  const std::optional<Isometry3>& seen = known.hands[side];
  const double upper = kUpperArm * height, lower = kForearm * height;
  Vec3 shoulder(out * kShoulderHalf * height, 0.0, 0.0);  // all in the frame of the chest

  // 1. The hand; it hangs down while it is not seen.
  const Vec3 hanging = shoulder + (upper + lower) * kHangs * Vec3(0.12 * out, -1.0, 0.1).normalized();
  if (seen) {
    arm.hand = worldFromChest.inverse() * seen->translation();
    arm.turned = Quat(seen->linear() * tposeFromGrip(side).transpose()).normalized();
  }
  arm.shown = std::clamp(first ? (seen ? 1.0 : 0.0) : arm.shown + (seen ? step : -step) / kHandComes, 0.0, 1.0);
  const bool sure = seen && arm.shown >= 1.0;
  const Vec3 hand = sure ? arm.hand : Vec3(hanging + arm.shown * (arm.hand - hanging));

  // 2. What the arm is too short for, the shoulder follows; then it is a longer arm.
  const Vec3 away = hand - shoulder;
  const double distance = away.norm(), length = upper + lower;
  if (sure) {
    const double reach = std::clamp((distance - kShrug * height) / length, 1.0, kLongestReach);
    reach_ += share(step, kReaches) * std::max(0.0, reach - reach_);
  }
  const double excess = std::clamp(distance - reach_ * length, 0.0, kShrug * height);
  if (distance > 0.0) shoulder += excess / distance * away;

  // 3. The elbow hangs down, outward and back, or where the forearm goes from how the hand is held.
  const Vec3 line = hand - shoulder;
  const double span = std::max(line.norm(), 1e-3);
  const Vec3 along = line / span;
  const double scale = std::max(reach_, span / length), a = scale * upper, b = scale * lower;
  const double before = std::clamp((a * a - b * b + span * span) / (2.0 * span), -a, a);
  Vec3 bend(0.45 * out, -0.9, -0.35);
  if (sure) {
    const Vec3 forearm = worldFromChest.linear().transpose() * seen->linear().col(1);
    bend += 2.5 * (hand + b * forearm - shoulder - before * along) / b;
  }
  bend -= bend.dot(along) * along;
  if (first) arm.bend = bend;
  arm.bend += share(step, kElbowTurns) * (bend - arm.bend);
  const Vec3 across = arm.bend - arm.bend.dot(along) * along;
  const Vec3 elbow =
      shoulder + before * along + std::sqrt(std::max(0.0, a * a - before * before)) * across.stableNormalized();

  const auto& [shoulderJoint, elbowJoint, handJoint] = kArms[side];
  frame[shoulderJoint] = {worldFromChest * shoulder, std::nullopt, kInferred};
  frame[elbowJoint] = {worldFromChest * elbow, std::nullopt, kInferred};
  frame[handJoint] = {sure ? seen->translation() : worldFromChest * hand, std::nullopt, sure ? 1.0 : kInferred};
  if (sure) frame[handJoint].orientation = arm.turned;
}

}  // namespace lorica
