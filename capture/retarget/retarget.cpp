#include "capture/retarget/retarget.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

/// Tracked joints closer than this define no direction [m].
constexpr double kShortestLimb = 0.01;
/// Angle between the limb's two bones below which elbow or knee gives no twist, and above which it gives all [rad].
/// With 2 cm of noise the plane of a 15-degree bend is accurate to only about 20 degrees.
constexpr double kHingeFrom = 0.26;
constexpr double kHingeFull = 1.05;
/// Max speed of a twist while it changes to another source [rad/s].
constexpr double kTwistSpeed = 8.0;
/// Outward rotation of an arm that points straight up, relative to the least twist from T-pose: palms forward [rad].
constexpr double kOverheadTurn = 0.5 * std::numbers::pi;
/// Lift of the collar bone under an arm that points straight up [rad].
constexpr double kClavicleLift = 0.35;
/// A foot joint up to the first value above its standing height is on the ground; from the second value on it is in the
/// air [m].
constexpr double kFootGrounded = 0.03;
constexpr double kFootInAir = 0.15;
/// Toes bend up fully if the ball of the foot is nearer to the floor than the first value, not at all above the second
/// [m].
constexpr double kBallGrounded = 0.02;
constexpr double kBallInAir = 0.10;
constexpr double kLargestToeBend = 1.05;
/// A sole may be this far below the floor before it lifts the character [m].
constexpr double kSoleSlack = 0.01;
/// Max speed at which the root is raised or lowered to fit the feet [m/s].
constexpr double kLiftSpeed = 1.5;
constexpr double kLegRatioSeconds = 1.0;

Quat about(const Vec3& axis, double angle) {
  return Quat(Eigen::AngleAxisd(angle, axis));
}

/// Wraps to [-pi, pi].
double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

/// Rotation angle of q about a unit axis that is, at least nearly, q's own axis [rad].
double twistAbout(const Quat& q, const Vec3& axis) {
  return wrapped(2.0 * std::atan2(q.vec().dot(axis), q.w()));
}

}  // namespace

std::optional<Vec3> Retargeter::Person::direction(BodyJoint a, BodyJoint b) const {
  if (!has(a) || !has(b)) return std::nullopt;
  const Vec3 v = at(b) - at(a);
  const double length = v.norm();
  if (length < kShortestLimb) return std::nullopt;
  return Vec3(v / length);
}

Result<Retargeter> Retargeter::create(const Skeleton& skeleton, const RetargetSettings& settings) {
  LORICA_TRY(RetargetRig rig, RetargetRig::create(skeleton));
  return Retargeter(std::move(rig), settings);
}

Retargeter::Retargeter(RetargetRig rig, const RetargetSettings& settings)
    : body_(std::move(rig)), settings_(settings), hold_(body_.rig.skeleton, settings.hold) {}

void Retargeter::apply(const SkeletonFrame& frame, std::span<JointTransform> pose) {
  const auto joints = body_.rig.skeleton.joints();
  LORICA_CHECK(pose.size() == joints.size(), "the pose must match the skeleton");
  hold_.beginFrame(frame.time);
  const Person person = readPerson(frame);
  measureLegs(person);
  measureFloor(person);

  // Parents first, relative to the parents' output: a seen forearm points right even under a held upper arm.
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto joint = static_cast<JointIndex>(j);
    const JointIndex parent = joints[j].parent;
    const Quat worldFromParent = parent == kNoJoint ? Quat::Identity() : body_.worldRotation[parent];
    pose[j] = joints[j].rest;
    if (joints[j].bone && *joints[j].bone <= HumanBone::kRightHand) {
      body_.worldRotation[j] =
          worldFromParent * joints[j].rest.rotation;  // orientationOf() reads the bone at rest from here
      const std::optional<Quat> turn = orientationOf(*joints[j].bone, joint, person);
      const Quat local = turn ? (worldFromParent.conjugate() * (*turn * body_.rig.tposeFromJoint[j])).normalized()
                              : joints[j].rest.rotation;
      pose[j].rotation = hold_.rotation(joint, turn.has_value(), local);
    }
    body_.worldRotation[j] = (worldFromParent * pose[j].rotation).normalized();
  }
  placeRoot(person, pose);
  if (settings_.plantFeet) plantFeet(person, pose);
}

Retargeter::Person Retargeter::readPerson(const SkeletonFrame& frame) {
  using J = BodyJoint;
  Person person;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    const TrackedJoint& joint = frame.joints[j];
    person.seen[j] = joint.confidence > 0.0 && joint.position.allFinite();
    person.position[j] = person.seen[j] ? joint.position : Vec3::Zero();
    if (!person.seen[j] || !joint.orientation) continue;
    const double length = joint.orientation->norm();
    if (length > 0.5 && length < 2.0) person.orientation[j] = joint.orientation->normalized();
  }

  const bool bothHips = person.has(J::kLeftHip) && person.has(J::kRightHip);
  if (bothHips) person.middleHip = 0.5 * (person.at(J::kLeftHip) + person.at(J::kRightHip));
  const std::optional<Quat>& torso = person.turnOf(J::kTorso);
  if (bothHips && (person.has(J::kTorso) || person.has(J::kNeck))) {
    const Vec3& above = person.at(person.has(J::kTorso) ? J::kTorso : J::kNeck);
    person.hips = frameAlongLeft(person.at(J::kLeftHip) - person.at(J::kRightHip), above - *person.middleHip);
  }
  if (!person.hips) person.hips = torso;

  // Reaching shifts the shoulders, so the torso's own orientation is a better estimate of the chest's facing.
  const bool trunk = person.has(J::kNeck) && (person.has(J::kTorso) || person.middleHip);
  if (trunk) {
    const Vec3 up = person.at(J::kNeck) - (person.has(J::kTorso) ? person.at(J::kTorso) : *person.middleHip);
    const bool left = person.has(J::kLeftShoulder);
    const bool right = person.has(J::kRightShoulder);
    if (torso && up.norm() >= kShortestLimb) {
      person.chest = pointed(*torso, Vec3::UnitY(), up.normalized(), Vec3::UnitX());
    } else if (left || right) {
      const Vec3 from = right ? person.at(J::kRightShoulder) : person.at(J::kNeck);
      const Vec3 to = left ? person.at(J::kLeftShoulder) : person.at(J::kNeck);
      person.chest = frameAlongUp(to - from, up);
    }
  }
  if (!person.chest) person.chest = torso;
  return person;
}

Quat Retargeter::shown(JointIndex joint) const {
  return body_.worldRotation[joint] * body_.rig.tposeFromJoint[joint].conjugate();
}

/// The orientation of a bone according to the person; nullopt if its joints are unknown.
std::optional<Quat> Retargeter::orientationOf(HumanBone bone, JointIndex joint, const Person& person) {
  using B = HumanBone;
  switch (bone) {
    case B::kHips:
      return person.hips;
    case B::kSpine:
    case B::kChest:
    case B::kUpperChest:
      return solveSpine(joint, person);
    case B::kNeck:
      return solveNeck(person);
    case B::kHead:
      return solveHead(person);
    case B::kLeftShoulder:
      return solveClavicle(0, person);
    case B::kRightShoulder:
      return solveClavicle(1, person);
    case B::kLeftToes:
      return solveToes(0, person);
    case B::kRightToes:
      return solveToes(1, person);
    default:
      break;
  }
  for (std::size_t i = 0; i < kLimbCount; ++i) {
    const LimbBones& limb = limbs()[i];
    if (bone == limb.upper) return solveUpper(i, person);
    if (bone == limb.lower) return solveLower(i, person);
    if (bone != limb.end) continue;
    if (person.turnOf(limb.endJoint)) return person.turnOf(limb.endJoint);
    if (i >= kFirstLeg) return solveFoot(i, person);
    if (person.direction(limb.lowerJoint, limb.endJoint)) return shown(joint);  // at rest relative to the forearm
  }
  return std::nullopt;
}

std::optional<Quat> Retargeter::solveSpine(JointIndex joint, const Person& person) const {
  if (!person.chest) return std::nullopt;
  return shown(body_.rig.hips).slerp(body_.rig.spineShare[joint], *person.chest);
}

std::optional<Quat> Retargeter::solveNeck(const Person& person) const {
  const std::optional<Vec3> direction = person.direction(BodyJoint::kNeck, BodyJoint::kHead);
  if (!direction) return std::nullopt;
  const Quat neck = pointed(shown(body_.rig.chest), body_.rig.neckAxis, *direction, Vec3::UnitX());
  const std::optional<Quat>& head = person.turnOf(BodyJoint::kHead);
  if (!head) return neck;
  const Quat turnedHead = pointed(*head, body_.rig.neckAxis, *direction, Vec3::UnitX());
  return about(*direction, 0.5 * twistAbout(turnedHead * neck.conjugate(), *direction)) * neck;
}

std::optional<Quat> Retargeter::solveHead(const Person& person) const {
  if (person.turnOf(BodyJoint::kHead)) return person.turnOf(BodyJoint::kHead);
  const std::optional<Vec3> direction = person.direction(BodyJoint::kNeck, BodyJoint::kHead);
  if (!direction) return std::nullopt;
  // Trackers position the head relative to the neck differently than characters do, so only half of the neck's tilt is
  // used.
  if (body_.rig.skeleton.jointOf(HumanBone::kNeck) != kNoJoint) {
    return shown(body_.rig.chest).slerp(0.5, shown(HumanBone::kNeck));
  }
  return pointed(shown(body_.rig.chest), body_.rig.neckAxis, *direction, Vec3::UnitX());
}

std::optional<Quat> Retargeter::solveClavicle(std::size_t limb, const Person& person) const {
  const std::optional<Vec3> arm = person.direction(limbs()[limb].upperJoint, limbs()[limb].lowerJoint);
  if (!arm) return std::nullopt;
  const Quat chest = shown(body_.rig.chest);
  const double lift = kClavicleLift * smoothStep(0.0, 1.0, (chest.conjugate() * *arm).y());
  return chest * about(Vec3::UnitZ(), limb == 0 ? lift : -lift);
}

/// Direction of forearm or shin. A backward bend of a shin is tracking noise and is removed.
std::optional<Vec3> Retargeter::lowerDirection(std::size_t limb, const Person& person) const {
  const LimbBones& l = limbs()[limb];
  const std::optional<Vec3> lower = person.direction(l.lowerJoint, l.endJoint);
  const std::optional<Vec3> upper = person.direction(l.upperJoint, l.lowerJoint);
  if (limb < kFirstLeg || !lower || !upper) return lower;
  const Quat swung = pointed(shown(body_.rig.hips), l.axis, *upper, l.hinge);
  const Vec3 hinge = swung * l.hinge;
  Vec3 bend = upper->cross(*lower);
  const double forwards = bend.dot(hinge);
  if (forwards >= 0.0) return lower;
  bend -= forwards * hinge;
  const Vec3 straightened = std::max(upper->dot(*lower), 0.0) * *upper + bend.cross(*upper);
  if (straightened.norm() < 1e-3) return upper;
  return Vec3(straightened.normalized());
}

/// Rotates the least-twisted orientation of a bone to the wanted twist. After a change of source the twist approaches
/// at a limited speed; then orientations are followed directly.
Quat Retargeter::twisted(const Quat& min, const Vec3& direction, double wanted, TwistSource source, Twist& twist) {
  // Near half a turn both directions are equivalent: stay on the current side.
  wanted = twist.angle + wrapped(wanted - twist.angle);
  if (std::abs(wanted) > 1.25 * std::numbers::pi) wanted = wrapped(wanted);
  if (twist.source == TwistSource::kNone) {
    twist.angle = wanted;
  } else {
    if (twist.source != source) twist.catchingUp = true;
    const double largest = kTwistSpeed * hold_.step();
    const double change = wanted - twist.angle;
    const bool bounded = twist.catchingUp || source != TwistSource::kOrientation;
    if (!bounded || std::abs(change) <= largest) {
      twist.angle = wanted;
      twist.catchingUp = false;
    } else {
      twist.angle += std::copysign(largest, change);
    }
  }
  twist.source = source;
  return (about(direction, twist.angle) * min).normalized();
}

std::optional<Quat> Retargeter::solveUpper(std::size_t limb, const Person& person) {
  const LimbBones& l = limbs()[limb];
  const std::optional<Vec3> direction = person.direction(l.upperJoint, l.lowerJoint);
  if (!direction) return std::nullopt;
  const bool leg = limb >= kFirstLeg;
  const Quat body = shown(leg ? body_.rig.hips : body_.rig.chest);
  Quat min = pointed(body, l.axis, *direction, l.hinge);
  if (!leg) {
    const double raised = smoothStep(0.0, 1.0, (body.conjugate() * *direction).y());
    min = min * about(Vec3::UnitX(), -kOverheadTurn * raised);
  }

  Twist& twist = upperTwist_[limb];
  if (const std::optional<Quat>& orientation = person.turnOf(l.upperJoint)) {
    const Quat measured = pointed(*orientation, l.axis, *direction, l.hinge);
    return twisted(min, *direction, twistAbout(measured * min.conjugate(), *direction), TwistSource::kOrientation,
                   twist);
  }
  const std::optional<Vec3> lower = lowerDirection(limb, person);
  if (!lower) return twisted(min, *direction, twist.angle, TwistSource::kMin, twist);  // keep the previous output
  const Vec3 hinge = direction->cross(*lower);
  const double share = smoothStep(kHingeFrom, kHingeFull, std::atan2(hinge.norm(), direction->dot(*lower)));
  double wanted = 0.0;
  if (share > 0.0) {
    const Vec3 from = min * l.hinge;
    wanted = std::atan2(from.cross(hinge).dot(*direction), from.dot(hinge));
    // Unwrap before weighting: the weight must not separate the two ends of the circle.
    wanted = share * (twist.angle + wrapped(wanted - twist.angle));
  }
  return twisted(min, *direction, wanted, TwistSource::kHinge, twist);
}

std::optional<Quat> Retargeter::solveLower(std::size_t limb, const Person& person) {
  const LimbBones& l = limbs()[limb];
  const std::optional<Vec3> direction = lowerDirection(limb, person);
  if (!direction) return std::nullopt;
  const Quat min = pointed(shown(l.upper), l.axis, *direction, l.hinge);
  Twist& twist = lowerTwist_[limb];
  const auto twistOf = [&](const Quat& orientation) {
    const Quat measured = pointed(orientation, l.axis, *direction, l.hinge);
    return twistAbout(measured * min.conjugate(), *direction);
  };
  if (const std::optional<Quat>& own = person.turnOf(l.lowerJoint)) {
    return twisted(min, *direction, twistOf(*own), TwistSource::kOrientation, twist);
  }
  // Radius and ulna cross: half of the hand's rotation is already visible in the forearm.
  const std::optional<Quat>& hand = person.turnOf(l.endJoint);
  if (limb < kFirstLeg && hand) return twisted(min, *direction, 0.5 * twistOf(*hand), TwistSource::kHinge, twist);
  return twisted(min, *direction, 0.0, TwistSource::kMin, twist);
}

/// A foot without an orientation: in the air at its rest angle to the shin, on the ground flat with the same heading.
std::optional<Quat> Retargeter::solveFoot(std::size_t limb, const Person& person) const {
  const LimbBones& l = limbs()[limb];
  if (!person.direction(l.lowerJoint, l.endJoint)) return std::nullopt;
  const Quat onShin = shown(l.end);
  const Vec3 forward = onShin * Vec3::UnitZ();
  const double level = std::hypot(forward.x(), forward.z());
  const double above = person.at(l.endJoint).y() - standingFoot_.value_or(0.0);
  const double flat = (1.0 - smoothStep(kFootGrounded, kFootInAir, above)) * smoothStep(0.2, 0.5, level);
  if (flat <= 0.0) return onShin;
  return onShin.slerp(flat, about(Vec3::UnitY(), std::atan2(forward.x(), forward.z())));
}

/// Toes stay level while the heel lifts off.
std::optional<Quat> Retargeter::solveToes(std::size_t side, const Person& person) const {
  const LimbBones& l = limbs()[kFirstLeg + side];
  if (!person.has(l.endJoint) || !person.has(l.lowerJoint)) return std::nullopt;
  const Quat foot = shown(l.end);
  const double ankle = legRatio_ * (person.at(l.endJoint).y() - standingFoot_.value_or(0.0));
  const double ball = ankle + body_.rig.restAnkleHeight[side] + (foot * body_.rig.ballFromAnkle[side]).y();
  const double pitch = std::asin(std::clamp(-(foot * Vec3::UnitZ()).y(), 0.0, std::sin(kLargestToeBend)));
  return foot * about(Vec3::UnitX(), -pitch * (1.0 - smoothStep(kBallGrounded, kBallInAir, ball)));
}

/// Estimates the ratio of leg lengths: the median of the first frames that show both legs, approached slowly.
void Retargeter::measureLegs(const Person& person) {
  using J = BodyJoint;
  const auto legSeen = [&](J hip, J knee, J foot) { return person.has(hip) && person.has(knee) && person.has(foot); };
  if (legLengthCount_ < kLegSamples && legSeen(J::kLeftHip, J::kLeftKnee, J::kLeftFoot) &&
      legSeen(J::kRightHip, J::kRightKnee, J::kRightFoot)) {
    const auto length = [&](J a, J b) { return (person.at(a) - person.at(b)).norm(); };
    const double mean = 0.5 * (length(J::kLeftHip, J::kLeftKnee) + length(J::kLeftKnee, J::kLeftFoot) +
                               length(J::kRightHip, J::kRightKnee) + length(J::kRightKnee, J::kRightFoot));
    if (mean > 0.1 && mean < 3.0) {
      legLengths_[legLengthCount_++] = mean;
      std::array<double, kLegSamples> sorted = legLengths_;
      const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(legLengthCount_ / 2);
      std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(legLengthCount_));
      medianLegLength_ = *middle;
      if (legLengthCount_ == 1) legRatio_ = body_.rig.legLength / medianLegLength_;
    }
  }
  if (legLengthCount_ == 0) return;
  const double share = 1.0 - std::exp(-hold_.step() / kLegRatioSeconds);
  legRatio_ += share * (body_.rig.legLength / medianLegLength_ - legRatio_);
}

/// Tracks the height of the lower foot: fast downwards, slowly upwards and only while it could still be standing.
void Retargeter::measureFloor(const Person& person) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const BodyJoint foot : {BodyJoint::kLeftFoot, BodyJoint::kRightFoot}) {
    if (person.has(foot)) lowest = std::min(lowest, person.at(foot).y());
  }
  if (!std::isfinite(lowest)) return;
  lowest = std::clamp(lowest, -0.2, 0.25);  // a foot outside this range is not standing
  if (!standingFoot_) standingFoot_ = lowest;
  const double above = lowest - *standingFoot_;
  if (above > 0.05) return;
  const double seconds = above < 0.0 ? 0.1 : 5.0;
  *standingFoot_ += (1.0 - std::exp(-hold_.step() / seconds)) * above;
}

void Retargeter::placeRoot(const Person& person, std::span<JointTransform> pose) {
  body_.evaluate(pose);
  const Vec3 middleHip = body_.middleHip();
  const Vec3 hipsFromMiddle = body_.worldFromJoint[body_.rig.hips].translation() - middleHip;
  // Height of each foot relative to its rest height, with the middle of the hips at y = 0: about minus the leg length.
  std::array<double, 2> footOverRest{};
  double lowest = std::numeric_limits<double>::infinity();
  for (int side = 0; side < 2; ++side) {
    const FootPosition foot = body_.foot(side);
    footOverRest[side] = foot.ankle.y() - middleHip.y() - body_.rig.restAnkleHeight[side];
    lowest = std::min(lowest, foot.lowest - middleHip.y() + kSoleSlack);
  }

  Vec3 position = Vec3::Zero();
  if (person.middleHip) {
    if (!lastMiddleHip_) {
      root_ = *person.middleHip;
    } else {
      root_ += legRatio_ * (*person.middleHip - *lastMiddleHip_);
    }
    root_.y() = 0.0;
    lastMiddleHip_ = person.middleHip;

    // The minimum over both feet is continuous, so stepping from one foot to the other causes no jump.
    double wanted = std::numeric_limits<double>::infinity();
    double actual = std::numeric_limits<double>::infinity();
    for (std::size_t side = 0; side < 2; ++side) {
      const BodyJoint foot = limbs()[kFirstLeg + side].endJoint;
      if (!person.has(foot)) continue;
      wanted = std::min(wanted, legRatio_ * std::max(0.0, person.at(foot).y() - *standingFoot_));
      actual = std::min(actual, footOverRest[side]);
    }
    const double scaledHeight = legRatio_ * person.middleHip->y();
    if (std::isfinite(wanted)) {
      const double lift = wanted - actual - scaledHeight;
      const double largest = kLiftSpeed * hold_.step();
      footLift_ = footLift_ ? *footLift_ + std::clamp(lift - *footLift_, -largest, largest) : lift;
    }
    position = root_ + Vec3(0.0, scaledHeight + footLift_.value_or(0.0), 0.0) + hipsFromMiddle;
  }
  Vec3 shownHips = hold_.rootPosition(person.middleHip.has_value(), position, body_.rig.restHips);
  // No sole goes below the floor, even while joints hold or ease: legs may straighten while the hips stay low.
  shownHips.y() = std::max(shownHips.y(), hipsFromMiddle.y() - lowest);
  pose[body_.rig.hips].translation = body_.rig.hipsParentFromWorld * shownHips;
}

void Retargeter::plantFeet(const Person& person, std::span<JointTransform> pose) {
  std::array<TrackedFoot, 2> feet;
  for (std::size_t side = 0; side < 2; ++side) {
    const LimbBones& leg = limbs()[kFirstLeg + side];
    const BodyJoint joint = leg.endJoint;
    feet[side].seen = person.has(joint) && person.has(leg.lowerJoint) && person.middleHip;
    if (!feet[side].seen) continue;
    feet[side].position = person.at(joint);
    feet[side].above = person.at(joint).y() - standingFoot_.value_or(0.0);
  }
  body_.evaluate(pose);
  footLock_.apply(body_, feet, legRatio_, hold_.step(), pose);
}

}  // namespace lorica
