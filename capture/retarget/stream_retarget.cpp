#include "capture/retarget/stream_retarget.h"

#include "geometry/counts.h"
#include "skinning/humanoid/humanoid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

/// A sender's thigh or shin shorter than this is taken as missing [m].
constexpr double kShortestSent = 0.02;
/// Hips nearer to the root than this came without a position [m].
constexpr double kNoLength = 1e-4;
/// A sender's floor is measured over this time [s] and corrected if it is off by more than this [m].
constexpr double kFloorSeconds = 1.0;
constexpr double kFloorTolerance = 0.05;

}  // namespace

Result<StreamRetargeter> StreamRetargeter::create(const Skeleton& skeleton, const RetargetSettings& settings) {
  LORICA_TRY(RetargetRig rig, RetargetRig::create(skeleton));
  return StreamRetargeter(std::move(rig), settings);
}

StreamRetargeter::StreamRetargeter(RetargetRig rig, const RetargetSettings& settings)
    : body_(std::move(rig)),
      settings_(settings),
      referenceFromJoint_(boneReference(body_.rig)),
      hold_(body_.rig.skeleton, settings.hold) {}

void StreamRetargeter::apply(const BonePose& sent, double time, bool known, std::span<JointTransform> pose) {
  LORICA_CHECK(pose.size() == body_.worldFromJoint.size(), "the pose must match the skeleton");
  hold_.beginFrame(time);
  const Sender sender = readSender(sent);
  if (known) measure(sender, time);
  turnBones(sent, sender, known, pose);
  placeRoot(sent, sender, known, pose);
  if (settings_.plantFeet && hasLegs_) plantFeet(sender, known, pose);
}

StreamRetargeter::Sender StreamRetargeter::readSender(const BonePose& sent) const {
  Sender sender{worldOf(sent)};
  sender.middleHip = 0.5 * (sender.position[ordinalOf(HumanBone::kLeftUpperLeg)] +
                            sender.position[ordinalOf(HumanBone::kRightUpperLeg)]);
  double length = 0.0;
  double shortest = std::numeric_limits<double>::infinity();
  for (int side = 0; side < 2; ++side) {
    const LimbBones& leg = limbs()[kFirstLeg + side];
    for (const HumanBone bone : {leg.lower, leg.end}) {
      const double bone_length = sent.offset[ordinalOf(bone)].norm();
      length += 0.5 * bone_length;
      shortest = std::min(shortest, bone_length);
    }
  }
  if (shortest >= kShortestSent) sender.legLength = length;
  return sender;
}

/// Legs are taken from the first frame that has them; the floor from the first second.
void StreamRetargeter::measure(const Sender& sender, double time) {
  if (!hasLegs_ && sender.legLength > 0.0) {
    hasLegs_ = true;
    legRatio_ = body_.rig.legLength / sender.legLength;
    firstTime_ = time;
    lowestAnkle_ = std::numeric_limits<double>::infinity();
  }
  if (!hasLegs_ || time - *firstTime_ > kFloorSeconds) return;
  for (int side = 0; side < 2; ++side) {
    const double standing = body_.rig.restAnkleHeight[side] / legRatio_;
    lowestAnkle_ = std::min(lowestAnkle_, sender.position[ordinalOf(limbs()[kFirstLeg + side].end)].y() - standing);
  }
  floor_ = std::abs(lowestAnkle_) > kFloorTolerance ? lowestAnkle_ : 0.0;
}

void StreamRetargeter::turnBones(const BonePose& sent, const Sender& sender, bool known,
                                 std::span<JointTransform> pose) {
  const std::span<const Joint> joints = body_.rig.skeleton.joints();
  for (int j = 0; j < countOf(joints); ++j) {
    const JointIndex parent = joints[j].parent;
    const Quat above = parent == kNoJoint ? Quat::Identity() : body_.worldRotation[parent];
    pose[j] = joints[j].rest;
    if (joints[j].bone) {
      const std::size_t bone = ordinalOf(*joints[j].bone);
      const Quat world = sender.turn[bone] * referenceFromJoint_[j];
      const bool given = known && sent.rotation[bone].has_value();
      pose[j].rotation = hold_.rotation(j, given, (above.conjugate() * world).normalized());
    }
    body_.worldRotation[j] = (above * pose[j].rotation).normalized();
  }
  body_.evaluate(pose);
}

void StreamRetargeter::placeRoot(const BonePose& sent, const Sender& sender, bool known,
                                 std::span<JointTransform> pose) {
  const Vec3 middleHip = body_.middleHip();
  Vec3 wanted = middleHip;
  if (known) {
    const bool hipsCome =
        sent.rotation[ordinalOf(HumanBone::kHips)] && sent.offset[ordinalOf(HumanBone::kHips)].norm() > kNoLength;
    const Vec3 hip =
        hasLegs_ ? sender.middleHip
                 : Vec3(sender.position[ordinalOf(HumanBone::kHips)] + middleHip - body_.positionOf(HumanBone::kHips));
    if (!firstHip_) firstHip_ = hip;
    wanted = scaledPath(*firstHip_, hip, legRatio_, floor_);
    if (hipsCome && !firstHipHeight_) firstHipHeight_ = hip.y();
    // Hips above legs that do not come tell only how they move: the body stood at first.
    const bool legsCome = sent.rotation[ordinalOf(HumanBone::kLeftUpperLeg)].has_value();
    if (!hasLegs_ && !(hipsCome && legsCome)) {
      wanted.y() = middleHip.y() + (hipsCome ? hip.y() - *firstHipHeight_ : 0.0);
    }
    if (hasLegs_) {
      // The lower ankle is as high as the sender's, scaled: shins and thighs of other proportions lead elsewhere.
      double above = std::numeric_limits<double>::infinity();
      double own = std::numeric_limits<double>::infinity();
      for (int side = 0; side < 2; ++side) {
        const HumanBone foot = limbs()[kFirstLeg + side].end;
        above = std::min(above, legRatio_ * (sender.position[ordinalOf(foot)].y() - floor_));
        own = std::min(own, body_.positionOf(foot).y() - middleHip.y() + wanted.y());
      }
      wanted.y() += above - own;
    }
  }
  const Vec3 shown = hold_.rootPosition(known, wanted, wanted);
  body_.moveHips(shown - middleHip, pose);
  body_.evaluate(pose);
}

void StreamRetargeter::plantFeet(const Sender& sender, bool known, std::span<JointTransform> pose) {
  std::array<TrackedFoot, 2> feet;
  for (int side = 0; side < 2; ++side) {
    feet[side].seen = known;
    feet[side].position = sender.position[ordinalOf(limbs()[kFirstLeg + side].end)];
    feet[side].above = feet[side].position.y() - floor_ - body_.rig.restAnkleHeight[side] / legRatio_;
  }
  footLock_.apply(body_, feet, legRatio_, hold_.step(), pose);
}

}  // namespace lorica
