#include "capture/retarget/retarget_rig.h"

#include "capture/retarget/human_rig.h"
#include "geometry/errors.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

namespace lorica {
namespace {

constexpr std::array kNeeded = {HumanBone::kHips,      HumanBone::kLeftUpperArm,  HumanBone::kLeftLowerArm,
                                HumanBone::kLeftHand,  HumanBone::kRightUpperArm, HumanBone::kRightLowerArm,
                                HumanBone::kRightHand, HumanBone::kLeftUpperLeg,  HumanBone::kLeftLowerLeg,
                                HumanBone::kLeftFoot,  HumanBone::kRightUpperLeg, HumanBone::kRightLowerLeg,
                                HumanBone::kRightFoot};
constexpr std::array kSpineBones = {HumanBone::kSpine, HumanBone::kChest, HumanBone::kUpperChest};

constexpr std::array kToes = {HumanBone::kLeftToes, HumanBone::kRightToes};

/// Bones shorter than this have no direction [m].
constexpr double kShortestBone = 1e-3;

bool descends(const Skeleton& skeleton, JointIndex joint, JointIndex ancestor) {
  while (joint != kNoJoint && joint != ancestor) joint = skeleton.joint(joint).parent;
  return joint == ancestor;
}

Result<void> checkBones(const Skeleton& skeleton, std::span<const Vec3> position) {
  std::string missing;
  for (const HumanBone bone : kNeeded) {
    if (skeleton.jointOf(bone) != kNoJoint) continue;
    missing += (missing.empty() ? "" : ", ") + std::string(nameOf(bone));
  }
  bool hasSpine = false;
  for (const HumanBone bone : kSpineBones) hasSpine = hasSpine || skeleton.jointOf(bone) != kNoJoint;
  if (!hasSpine) missing += (missing.empty() ? "" : ", ") + std::string("spine (or chest)");
  if (!missing.empty()) {
    return invalidArgument("the skeleton lacks humanoid bones that retargeting needs: {}", missing);
  }

  const auto checkPair = [&](HumanBone child, HumanBone parent) -> Result<void> {
    if (!descends(skeleton, skeleton.jointOf(child), skeleton.jointOf(parent))) {
      return invalidArgument("the bone {} does not descend from {}", nameOf(child), nameOf(parent));
    }
    return {};
  };
  const auto checkLength = [&](HumanBone child, HumanBone parent) -> Result<void> {
    const double length = (position[skeleton.jointOf(child)] - position[skeleton.jointOf(parent)]).norm();
    if (!(length >= kShortestBone)) {
      return invalidArgument("the bone {} is {:.3g} m long in the rest pose, expected at least {} m", nameOf(parent),
                             length, kShortestBone);
    }
    return {};
  };
  for (const LimbBones& limb : limbs()) {
    LORICA_TRY_DO(checkPair(limb.upper, HumanBone::kHips));
    LORICA_TRY_DO(checkPair(limb.lower, limb.upper));
    LORICA_TRY_DO(checkPair(limb.end, limb.lower));
    LORICA_TRY_DO(checkLength(limb.lower, limb.upper));
    LORICA_TRY_DO(checkLength(limb.end, limb.lower));
  }
  return {};
}

double legLengthOf(const RetargetRig& rig, std::span<const Affine3> worldFromJoint, std::size_t side) {
  const LimbBones& leg = limbs()[kFirstLeg + side];
  const auto at = [&](HumanBone bone) -> Vec3 { return worldFromJoint[rig.skeleton.jointOf(bone)].translation(); };
  return (at(leg.lower) - at(leg.upper)).norm() + (at(leg.end) - at(leg.lower)).norm();
}

/// Estimates the sole, because a skeleton only contains the joints above it. The floor is y = 0 in the rest pose,
/// unless that is implausible for the ankle height or the rest pose does not stand; then the floor is under the toes.
/// @param ground  worldFromGround: +Y away from the floor, +Z ahead
void measureFoot(RetargetRig& rig, std::span<const Affine3> worldFromJoint, std::size_t side, const Quat& ground,
                 bool stands) {
  // Fractions of the distance from ankle to toes, and of the leg, for adults.
  constexpr double kHeelBehind = 0.45;
  constexpr double kTipAhead = 0.55;
  constexpr double kToesAhead = 0.16;
  constexpr double kShortestFoot = 0.08;
  constexpr double kAnkleHeight = 0.1;
  constexpr double kToesHeight = 0.03;
  constexpr double kLowestAnkle = 0.05;
  constexpr double kHighestAnkle = 0.35;
  const Skeleton& skeleton = rig.skeleton;
  const Affine3& foot = worldFromJoint[skeleton.jointOf(limbs()[kFirstLeg + side].end)];
  const JointIndex toesJoint = skeleton.jointOf(kToes[side]);
  const Affine3& toes = toesJoint == kNoJoint ? foot : worldFromJoint[toesJoint];
  const Vec3 ankle = foot.translation();
  const double leg = legLengthOf(rig, worldFromJoint, side);
  Vec3 ahead = ground.conjugate() * (toes.translation() - ankle);
  const double toesUnder = -ahead.y();
  const bool floorAtZero = stands && ankle.y() >= 0.0 && ankle.y() < kHighestAnkle * leg;
  if (floorAtZero) {
    rig.restAnkleHeight[side] = ankle.y();
  } else if (toesJoint != kNoJoint) {
    rig.restAnkleHeight[side] = std::clamp(toesUnder + kToesHeight * leg, kLowestAnkle * leg, kHighestAnkle * leg);
  } else {
    rig.restAnkleHeight[side] = kAnkleHeight * leg;
  }

  ahead.y() = 0.0;
  if (ahead.z() < kShortestBone) {
    ahead = Vec3(0.0, 0.0, kToesAhead * leg);
  } else if (std::abs(ahead.x()) < ahead.z()) {
    rig.toesHeading[side] = Quat(Eigen::AngleAxisd(std::atan2(ahead.x(), ahead.z()), Vec3::UnitY()));
  }
  // A joint under the ankle is in the heel, not where the toes begin.
  if (ahead.norm() < kShortestFoot * leg) ahead *= kToesAhead * leg / ahead.norm();
  rig.ballFromAnkle[side] = ahead - Vec3(0.0, rig.restAnkleHeight[side], 0.0);
  const auto below = [&](double share) -> Vec3 {
    return ankle + ground * Vec3(share * ahead - Vec3(0.0, rig.restAnkleHeight[side], 0.0));
  };
  rig.sole[side].heel = foot.inverse() * below(-kHeelBehind);
  rig.sole[side].ball = foot.inverse() * below(1.0);
  rig.sole[side].tip = toes.inverse() * below(1.0 + kTipAhead);
}

/// Rotation that makes a rest pose's foot stand. It may point down, as in files whose limbs are all aligned with axes.
Quat flatFoot(const Vec3& toesFromAnkle) {
  constexpr double kSteepest = 0.95;  // sine; high heels and toe joints under the ankle stay below
  constexpr double kSlope = 0.45;     // slope of the line from ankle to toes in a standing foot [rad]
  const double length = toesFromAnkle.norm();
  if (length < kShortestBone || std::abs(toesFromAnkle.y()) < kSteepest * length) return Quat::Identity();
  const Vec3 standing(0.0, -std::sin(kSlope), std::cos(kSlope));
  return swingBetween(toesFromAnkle / length, standing, Vec3::UnitX());
}

/// The one joint without children below the head whose name says that it is its end; kNoJoint if there is none.
JointIndex endOfHead(const Skeleton& skeleton) {
  constexpr std::array<std::string_view, 5> kWords = {"end", "top", "nub", "site", "effector"};
  const JointIndex head = skeleton.jointOf(HumanBone::kHead);
  JointIndex found = kNoJoint;
  for (JointIndex j = head + 1; head != kNoJoint && j < skeleton.jointCount(); ++j) {
    if (found != kNoJoint && skeleton.joint(j).parent == found) return kNoJoint;
    const std::string name = lowerCase(skeleton.joint(j).name);
    const bool named = std::any_of(kWords.begin(), kWords.end(),
                                   [&](std::string_view word) { return name.find(word) != std::string::npos; });
    if (skeleton.joint(j).parent == head && named && !skeleton.joint(j).bone) {
      if (found != kNoJoint) return kNoJoint;
      found = j;
    }
  }
  return found;
}

/// How far a head looks down at rest, about +X [rad]: by the line to its end, if that follows an axis of the joint. Of
/// other heads the end is not straight above the joint when they look ahead.
/// @param chestFromEnd  the line in the frame of the chest: left, up, ahead
double bowOfHead(const Vec3& chestFromEnd, const Vec3& jointFromEnd) {
  constexpr double kAlongAxis = 0.99;
  constexpr double kLeast = 0.2;  // heads of usual shape are built this askew
  constexpr double kMost = 1.2;
  const double length = chestFromEnd.norm();
  if (length < kShortestBone || jointFromEnd.cwiseAbs().maxCoeff() < kAlongAxis * jointFromEnd.norm()) return 0.0;
  const double bow = std::atan2(chestFromEnd.z(), chestFromEnd.y());
  return std::abs(bow) > kLeast && std::abs(bow) < kMost ? bow : 0.0;
}

/// A finger's bones from the palm outwards.
using Finger = std::array<HumanBone, 3>;
constexpr std::array<std::array<Finger, 4>, 2> kFingers = {{
    {{{HumanBone::kLeftIndexProximal, HumanBone::kLeftIndexIntermediate, HumanBone::kLeftIndexDistal},
      {HumanBone::kLeftMiddleProximal, HumanBone::kLeftMiddleIntermediate, HumanBone::kLeftMiddleDistal},
      {HumanBone::kLeftRingProximal, HumanBone::kLeftRingIntermediate, HumanBone::kLeftRingDistal},
      {HumanBone::kLeftLittleProximal, HumanBone::kLeftLittleIntermediate, HumanBone::kLeftLittleDistal}}},
    {{{HumanBone::kRightIndexProximal, HumanBone::kRightIndexIntermediate, HumanBone::kRightIndexDistal},
      {HumanBone::kRightMiddleProximal, HumanBone::kRightMiddleIntermediate, HumanBone::kRightMiddleDistal},
      {HumanBone::kRightRingProximal, HumanBone::kRightRingIntermediate, HumanBone::kRightRingDistal},
      {HumanBone::kRightLittleProximal, HumanBone::kRightLittleIntermediate, HumanBone::kRightLittleDistal}}},
}};
constexpr std::array<Finger, 2> kThumbs = {{
    {HumanBone::kLeftThumbMetacarpal, HumanBone::kLeftThumbProximal, HumanBone::kLeftThumbDistal},
    {HumanBone::kRightThumbMetacarpal, HumanBone::kRightThumbProximal, HumanBone::kRightThumbDistal},
}};

}  // namespace

const std::array<LimbBones, kLimbCount>& limbs() {
  using B = HumanBone;
  using J = BodyJoint;
  // Palms down, the forearm folds forward: about -Y on the left. The shin folds back: about +X.
  static const std::array<LimbBones, kLimbCount> all = {{
      {B::kLeftUpperArm, B::kLeftLowerArm, B::kLeftHand, J::kLeftShoulder, J::kLeftElbow, J::kLeftHand, Vec3::UnitX(),
       -Vec3::UnitY()},
      {B::kRightUpperArm, B::kRightLowerArm, B::kRightHand, J::kRightShoulder, J::kRightElbow, J::kRightHand,
       -Vec3::UnitX(), Vec3::UnitY()},
      {B::kLeftUpperLeg, B::kLeftLowerLeg, B::kLeftFoot, J::kLeftHip, J::kLeftKnee, J::kLeftFoot, -Vec3::UnitY(),
       Vec3::UnitX()},
      {B::kRightUpperLeg, B::kRightLowerLeg, B::kRightFoot, J::kRightHip, J::kRightKnee, J::kRightFoot, -Vec3::UnitY(),
       Vec3::UnitX()},
  }};
  return all;
}

HumanBone otherSide(HumanBone bone) {
  static const std::array<HumanBone, kHumanBoneCount> others = [] {
    std::array<HumanBone, kHumanBoneCount> all{};
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i] = static_cast<HumanBone>(i);
      std::string name(nameOf(all[i]));
      if (name.starts_with("left"))
        name.replace(0, 4, "right");
      else if (name.starts_with("right"))
        name.replace(0, 5, "left");
      all[i] = humanBoneNamed(name).value_or(all[i]);
    }
    return all;
  }();
  return others[static_cast<std::size_t>(bone)];
}

std::optional<Quat> frameAlongLeft(const Vec3& left, const Vec3& up) {
  const Vec3 forward = left.cross(up);
  constexpr double kSmallestSine = 0.1;
  if (left.norm() < kShortestBone || up.norm() < kShortestBone) return std::nullopt;
  if (forward.norm() < kSmallestSine * left.norm() * up.norm()) return std::nullopt;
  Mat3 axes;
  axes.col(0) = left.normalized();
  axes.col(2) = forward.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Quat(axes).normalized();
}

std::optional<Quat> frameAlongUp(const Vec3& left, const Vec3& up) {
  return frameAlongLeft(left - left.dot(up) / std::max(up.squaredNorm(), 1e-12) * up, up);
}

Quat swingBetween(const Vec3& from, const Vec3& to, const Vec3& spare) {
  const double cosine = from.dot(to);
  if (cosine < -1.0 + 1e-9) {
    const Vec3 axis = spare - spare.dot(from) * from;
    return Quat(Eigen::AngleAxisd(std::numbers::pi, axis.normalized()));
  }
  // Half-angle form: w = 1 + cos, v = from x to, both scaled by 2 cos(angle / 2).
  const Vec3 v = from.cross(to);
  return Quat(1.0 + cosine, v.x(), v.y(), v.z()).normalized();
}

Quat pointed(const Quat& orientation, const Vec3& axis, const Vec3& direction, const Vec3& spare) {
  return (swingBetween(orientation * axis, direction, orientation * spare) * orientation).normalized();
}

double smoothStep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Result<RetargetRig> RetargetRig::create(const Skeleton& skeleton) {
  const auto count = static_cast<std::size_t>(skeleton.jointCount());
  const Pose rest = restPose(skeleton);
  std::vector<Affine3> worldFromJoint(count);
  std::vector<Vec3> position(count);
  std::vector<Quat> worldRotation(count);
  evaluatePose(skeleton, rest, worldRotation, worldFromJoint);
  for (std::size_t j = 0; j < count; ++j) position[j] = worldFromJoint[j].translation();
  LORICA_TRY_DO(checkBones(skeleton, position));

  const auto has = [&](HumanBone bone) { return skeleton.jointOf(bone) != kNoJoint; };
  const auto at = [&](HumanBone bone) -> const Vec3& { return position[skeleton.jointOf(bone)]; };
  const auto mid = [&](HumanBone a, HumanBone b) -> Vec3 { return 0.5 * (at(a) + at(b)); };

  // The trunk's frames in the rest pose. A tracker's torso lies on the line from the hips to the neck, so the curve of
  // the character's spine is part of its rest pose, and only that line defines the up direction.
  const Vec3 middleHip = mid(HumanBone::kLeftUpperLeg, HumanBone::kRightUpperLeg);
  const Vec3 middleShoulder = mid(HumanBone::kLeftUpperArm, HumanBone::kRightUpperArm);
  const Vec3 up = (has(HumanBone::kNeck) ? at(HumanBone::kNeck) : middleShoulder) - middleHip;
  const Vec3 hipLine = at(HumanBone::kLeftUpperLeg) - at(HumanBone::kRightUpperLeg);
  const Vec3 shoulderLine = at(HumanBone::kLeftUpperArm) - at(HumanBone::kRightUpperArm);
  const std::optional<Quat> hipsFrame = frameAlongLeft(hipLine, up);
  const std::optional<Quat> chestFrame = frameAlongUp(shoulderLine, up);
  constexpr double kUpright = 0.5;
  const bool stands = up.y() > kUpright * up.norm();
  const std::optional<Quat> groundFrame = stands ? frameAlongUp(hipLine, Vec3::UnitY()) : hipsFrame;
  if (!hipsFrame || !chestFrame || !groundFrame) {
    return invalidArgument(
        "the skeleton's rest pose does not define a trunk frame: hips, shoulders and neck are collinear");
  }

  RetargetRig rig;
  rig.skeleton = skeleton;
  rig.tposeFromJoint.assign(count, Quat::Identity());
  rig.spineShare.assign(count, 0.0);
  const auto index = [&](HumanBone bone) { return static_cast<std::size_t>(skeleton.jointOf(bone)); };
  const auto set = [&](HumanBone bone, const Quat& tposeFromRest) {
    if (has(bone)) rig.tposeFromJoint[index(bone)] = (tposeFromRest * worldRotation[index(bone)]).normalized();
  };

  // Trunk: the bend from hips to chest is distributed, most of it at and above the waist.
  rig.hips = skeleton.jointOf(HumanBone::kHips);
  set(HumanBone::kHips, hipsFrame->conjugate());
  std::vector<HumanBone> spine;
  for (const HumanBone bone : kSpineBones) {
    if (has(bone)) spine.push_back(bone);
  }
  constexpr std::array<std::array<double, 3>, 3> kShares = {{{1.0, 0.0, 0.0}, {0.4, 1.0, 0.0}, {0.3, 0.75, 1.0}}};
  for (std::size_t i = 0; i < spine.size(); ++i) {
    const double share = kShares[spine.size() - 1][i];
    rig.spineShare[index(spine[i])] = share;
    set(spine[i], hipsFrame->slerp(share, *chestFrame).conjugate());
  }
  rig.chest = skeleton.jointOf(spine.back());
  const Quat tposeFromRest = chestFrame->conjugate();
  for (const HumanBone bone :
       {HumanBone::kNeck, HumanBone::kHead, HumanBone::kLeftShoulder, HumanBone::kRightShoulder}) {
    set(bone, tposeFromRest);
  }
  if (const JointIndex end = endOfHead(skeleton); end != kNoJoint) {
    const double bow = bowOfHead(tposeFromRest * (position[end] - at(HumanBone::kHead)), rest[end].translation);
    if (bow != 0.0) set(HumanBone::kHead, Quat(Eigen::AngleAxisd(-bow, Vec3::UnitX())) * tposeFromRest);
  }
  if (has(HumanBone::kNeck) && has(HumanBone::kHead)) {
    const Vec3 neck = at(HumanBone::kHead) - at(HumanBone::kNeck);
    if (neck.norm() >= kShortestBone) rig.neckAxis = tposeFromRest * neck.normalized();
  }

  // Limbs: swung into the T-pose one after the other, so that an elbow bent at rest is straight in T-pose.
  for (std::size_t i = 0; i < kLimbCount; ++i) {
    const LimbBones& limb = limbs()[i];
    const bool leg = i >= kFirstLeg;
    const Quat body = (leg ? *hipsFrame : *chestFrame).conjugate();
    const Vec3 upper = (at(limb.lower) - at(limb.upper)).normalized();
    const Vec3 lower = (at(limb.end) - at(limb.lower)).normalized();
    const Quat upperSwing = swingBetween(body * upper, limb.axis, limb.hinge) * body;
    const Quat lowerSwing = swingBetween(upperSwing * lower, limb.axis, limb.hinge) * upperSwing;
    set(limb.upper, upperSwing);
    set(limb.lower, lowerSwing);
    // A hand follows its forearm, and the fingers follow the hand except for their curl.
    if (!leg) {
      set(limb.end, lowerSwing);
      for (const HumanBone bone : kThumbs[i]) set(bone, lowerSwing);
      for (const Finger& finger : kFingers[i]) {
        Quat swing = lowerSwing;
        Vec3 flat = limb.axis;
        for (std::size_t k = 0; k < finger.size(); ++k) {
          if (k + 1 < finger.size() && has(finger[k]) && has(finger[k + 1])) {
            const Vec3 along = swing * (at(finger[k + 1]) - at(finger[k]));
            if (k == 0) flat = Vec3(along.x(), 0.0, along.z());
            if (along.norm() >= kShortestBone && flat.dot(limb.axis) > 0.3 * along.norm()) {
              swing = swingBetween(along.normalized(), flat.normalized(), Vec3::UnitY()) * swing;
            }
          }
          set(finger[k], swing);
        }
      }
      continue;
    }
    const std::size_t side = i - kFirstLeg;
    Quat ground = *groundFrame;
    if (has(kToes[side])) {
      ground = ground * flatFoot(ground.conjugate() * (at(kToes[side]) - at(limb.end))).conjugate();
      set(kToes[side], ground.conjugate());
    }
    set(limb.end, ground.conjugate());
    rig.legLength += 0.5 * legLengthOf(rig, worldFromJoint, side);
    measureFoot(rig, worldFromJoint, side, ground, stands && ground.angularDistance(*groundFrame) < 1e-9);
  }

  rig.restHips = at(HumanBone::kHips);
  const JointIndex hipsParent = skeleton.joint(rig.hips).parent;
  if (hipsParent != kNoJoint) {
    const Affine3& worldFromParent = worldFromJoint[hipsParent];
    if (!(std::abs(worldFromParent.linear().determinant()) > 1e-18)) {
      return invalidArgument("the joints above {} have zero scale", skeleton.joint(rig.hips).name);
    }
    rig.hipsParentFromWorld = worldFromParent.inverse();
  }
  return rig;
}

}  // namespace lorica
