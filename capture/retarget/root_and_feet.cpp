#include "capture/retarget/root_and_feet.h"

#include "capture/retarget/human_rig.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// Limits are for a person with 0.85 m long legs and scale with leg length.
constexpr double kUsualLegLength = 0.85;
/// A foot locks below the first speed and stays locked below the second [m/s].
constexpr double kSlowRoot = 0.25;
constexpr double kStillSlowRoot = 0.45;
/// Likewise for the ankle height above its standing height [m].
constexpr double kLowRoot = 0.05;
constexpr double kStillLowRoot = 0.09;
/// A sensor's jitter is faster than this and has no preferred direction [s].
constexpr double kSmoothing = 0.07;
/// Max distance of an ankle from its anchor: a nearly straight leg bends by degrees for millimetres [m].
constexpr double kTolerance = 0.005;
/// Time for a lost leg to return, see ConfidenceHoldSettings::returnSeconds [s].
constexpr double kComesBack = 0.5;
constexpr double kReleaseSeconds = 0.08;
constexpr double kReleaseSpeed = 0.5;  // max, for a leg of the usual length [m/s]
/// The root follows the locked feet with this time constant, and the other feet only a little [s].
constexpr double kRootShiftSeconds = 0.08;
constexpr double kWeightInAir = 0.02;
constexpr double kSettleSeconds = 0.08;
/// A lock that has to pull a foot further than this fraction of the leg is released.
constexpr double kLongestPull = 0.15;
/// Speed at which the root rises again [m/s].
constexpr double kRiseSpeed = 0.3;
/// Smaller corrections are ignored [m].
constexpr double kNothing = 1e-9;

/// The part of a vector beyond a tolerance.
Vec3 beyond(const Vec3& v, double forgiven) {
  const double length = v.norm();
  return length > forgiven ? Vec3((1.0 - forgiven / length) * v) : Vec3::Zero();
}

double shareWithin(double step, double seconds) {
  return 1.0 - std::exp(-step / seconds);
}

}  // namespace

PosedBody::PosedBody(RetargetRig ofCharacter)
    : rig(std::move(ofCharacter)),
      worldRotation(rig.tposeFromJoint.size(), Quat::Identity()),
      worldFromJoint(rig.tposeFromJoint.size()) {}

void PosedBody::evaluate(std::span<const JointTransform> pose) {
  evaluatePose(rig.skeleton, pose, worldRotation, worldFromJoint);
}

Vec3 PosedBody::positionOf(HumanBone bone) const {
  return worldFromJoint[rig.skeleton.jointOf(bone)].translation();
}

Vec3 PosedBody::middleHip() const {
  return 0.5 * (positionOf(HumanBone::kLeftUpperLeg) + positionOf(HumanBone::kRightUpperLeg));
}

FootPosition PosedBody::foot(int side) const {
  const Affine3& ankle = worldFromJoint[rig.skeleton.jointOf(limbs()[kFirstLeg + side].end)];
  const JointIndex toesJoint = rig.skeleton.jointOf(side == 0 ? HumanBone::kLeftToes : HumanBone::kRightToes);
  const Affine3& toes = toesJoint == kNoJoint ? ankle : worldFromJoint[toesJoint];
  const RetargetRig::Sole& sole = rig.sole[side];
  const Vec3 ball = ankle * sole.ball;
  return {ankle.translation(), ball, std::min({(ankle * sole.heel).y(), ball.y(), (toes * sole.tip).y()})};
}

void PosedBody::moveHips(const Vec3& by, std::span<JointTransform> pose) const {
  pose[rig.hips].translation += rig.hipsParentFromWorld.linear() * by;
}

void PosedBody::bendLeg(int side, const Vec3& ankle, std::span<JointTransform> pose) const {
  const LimbBones& leg = limbs()[kFirstLeg + side];
  const auto turnOf = [&](HumanBone bone) -> const Quat& { return worldRotation[rig.skeleton.jointOf(bone)]; };
  const Quat& tpose = rig.tposeFromJoint[rig.skeleton.jointOf(leg.upper)];
  const Vec3 hinge = turnOf(leg.upper) * (tpose.conjugate() * leg.hinge);
  const LegTurns turns = reachWithLeg(positionOf(leg.upper), positionOf(leg.lower), positionOf(leg.end), hinge, ankle);
  // Joints between two of these rotate with the upper one.
  const auto set = [&](HumanBone bone, const Quat& turnAbove, const Quat& turn) {
    const JointIndex joint = rig.skeleton.jointOf(bone);
    const JointIndex parent = rig.skeleton.joint(joint).parent;
    const Quat above = parent == kNoJoint ? Quat::Identity() : worldRotation[parent];
    pose[joint].rotation = ((turnAbove * above).conjugate() * turn * worldRotation[joint]).normalized();
  };
  set(leg.upper, Quat::Identity(), turns.thigh);
  set(leg.lower, turns.thigh, turns.shin);
  set(leg.end, turns.shin, Quat::Identity());
}

Vec3 scaledPath(const Vec3& start, const Vec3& hip, double ratio, double floor) {
  Vec3 position = start + ratio * (hip - start);
  position.y() = ratio * (hip.y() - floor);
  return position;
}

/// Decides whether a foot is locked, and updates its anchor.
void FootLock::follow(Foot& foot, const TrackedFoot& tracked, const Vec3& posed, double size, double ratio,
                      double step) {
  if (!tracked.seen && foot.hasShown) foot.unsettled = kComesBack;
  if (tracked.seen) foot.unsettled = std::max(0.0, foot.unsettled - step);
  const bool known = tracked.seen && foot.seen && foot.hasShown && step > 0.0;
  const Vec3 moved = known ? Vec3(tracked.position - foot.position) : Vec3::Zero();
  bool locked = false;
  if (known) {
    const Vec3 velocity = moved / step;
    foot.velocity += shareWithin(step, kSmoothing) * (velocity - foot.velocity);
    const double speed = std::min(velocity.norm(), foot.velocity.norm()) / size;
    const double above = tracked.above / size;
    locked = foot.unsettled > 0.0 ? false
             : foot.locked        ? speed < kStillSlowRoot && above < kStillLowRoot
                                  : speed < kSlowRoot && above < kLowRoot;
  } else if (tracked.seen) {
    foot.velocity.setZero();
  }
  if (locked) {
    // In the first locked frame, too, the anchor starts from the previously shown position: the foot has stood still
    // since then.
    foot.anchor = (foot.locked ? foot.anchor : foot.shown) + ratio * moved;
    const Vec3 pull = foot.anchor - posed;
    locked = std::hypot(pull.x(), pull.z()) < kLongestPull * kUsualLegLength * size * ratio;
  }
  foot.locked = locked;
  foot.seen = tracked.seen;
  foot.position = tracked.position;
}

void FootLock::apply(PosedBody& body, const std::array<TrackedFoot, 2>& feet, double ratio, double step,
                     std::span<JointTransform> pose) {
  const RetargetRig& rig = body.rig;
  const double size = rig.legLength / (ratio * kUsualLegLength);  // of the person
  const auto at = [&](HumanBone bone) { return body.positionOf(bone); };
  const double tolerance = kTolerance * std::min(1.0, rig.legLength / kUsualLegLength);
  std::array<Vec3, 2> posed;
  Vec3 asked = Vec3::Zero();
  double weights = 0.0;
  for (int side = 0; side < 2; ++side) {
    Foot& foot = feet_[side];
    posed[side] = at(limbs()[kFirstLeg + side].end);
    follow(foot, feet[side], posed[side], size, ratio, step);
    const double weight = foot.locked ? 1.0 : kWeightInAir;
    asked += weight * (foot.locked ? Vec3(foot.anchor - posed[side]) : foot.correction);
    weights += weight;
  }
  asked.y() = 0.0;
  shift_ += shareWithin(step, kRootShiftSeconds) * (asked / weights - shift_);

  std::array<Vec3, 2> wanted;
  double need = 0.0;
  bool none = shift_.norm() < kNothing;
  for (int side = 0; side < 2; ++side) {
    const LimbBones& leg = limbs()[kFirstLeg + side];
    Foot& foot = feet_[side];
    // Heights are already right for the lower foot; the other one is adjusted to its own.
    double lift = 0.0;
    if (foot.locked) {
      Vec3 away = posed[side] + shift_ - foot.anchor;
      away.y() = 0.0;
      const Vec3 level = shift_ - beyond(away, tolerance);
      foot.correction.x() = level.x();
      foot.correction.z() = level.z();
      const double height = rig.restAnkleHeight[side] + ratio * std::max(0.0, feet[side].above);
      lift = -beyond(Vec3(0.0, posed[side].y() - height, 0.0), tolerance).y();
    } else {
      // Each step takes back a part of the root's shift, so that it does not accumulate.
      const Vec3 rest = beyond(shift_, std::max(tolerance, 0.4 * shift_.norm())) - foot.correction;
      const double length = std::max(std::hypot(rest.x(), rest.z()), kNothing);
      const double fastest = kReleaseSpeed * step * rig.legLength / kUsualLegLength;
      const double share = std::min(shareWithin(step, kReleaseSeconds), fastest / length);
      foot.correction.x() += share * rest.x();
      foot.correction.z() += share * rest.z();
    }
    foot.correction.y() += shareWithin(step, kSettleSeconds) * (lift - foot.correction.y());
    wanted[side] = posed[side] + foot.correction;
    none = none && foot.correction.norm() < kNothing;
    need =
        std::max(need, dropToReach(at(leg.upper) + shift_, at(leg.lower) + shift_, posed[side] + shift_, wanted[side]));
  }
  nudge_ = std::clamp(std::max(need, nudge_ - kRiseSpeed * step), 0.0, kLongestPull * rig.legLength);
  if (!none || nudge_ > kNothing) {
    const Vec3 by = shift_ - Vec3(0.0, nudge_, 0.0);
    body.moveHips(by, pose);
    for (Affine3& joint : body.worldFromJoint) joint.pretranslate(by);
    for (int side = 0; side < 2; ++side) body.bendLeg(side, wanted[side], pose);
    body.evaluate(pose);
  }
  for (int side = 0; side < 2; ++side) {
    feet_[side].shown = at(limbs()[kFirstLeg + side].end);
    feet_[side].hasShown = true;
  }
}

}  // namespace lorica
