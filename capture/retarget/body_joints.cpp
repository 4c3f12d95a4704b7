#include "capture/retarget/skeletal_retarget.h"

#include "capture/retarget/completed_skeleton.h"
#include "capture/retarget/human_rig.h"
#include "capture/retarget/mirrored_axes.h"
#include "capture/retarget/retarget.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>

namespace lorica {
namespace {

using B = HumanBone;
using J = BodyJoint;

/// A floor closer to y = 0 than this is left unchanged [m].
constexpr double kFloorIsZero = 0.05;

bool seen(const SkeletonFrame& frame, std::initializer_list<J> joints) {
  return std::all_of(joints.begin(), joints.end(),
                     [&](J joint) { return frame[joint].confidence > 0.0 && frame[joint].position.allFinite(); });
}

Vec3 middleOf(const SkeletonFrame& frame, J left, J right) {
  return 0.5 * (frame[left].position + frame[right].position);
}

/// Bone lengths of the person in the frames.
class Lengths {
 public:
  explicit Lengths(const std::vector<SkeletonFrame>& frames) : frames_(frames) {}

  /// Median distance of two joints; `otherwise` if they are never seen together [m].
  [[nodiscard]] double between(J a, J b, double otherwise) const {
    const auto distance = [&](const SkeletonFrame& frame) { return (frame[a].position - frame[b].position).norm(); };
    return atLeast(median({a, b}, distance, otherwise));
  }
  /// Distance from the middle of two joints to a third.
  [[nodiscard]] double fromMiddle(J left, J right, J other, double otherwise) const {
    const auto distance = [&](const SkeletonFrame& frame) {
      return (middleOf(frame, left, right) - frame[other].position).norm();
    };
    return atLeast(median({left, right, other}, distance, otherwise));
  }
  /// Combined value for both sides of the body.
  [[nodiscard]] double ofBoth(J leftA, J leftB, J rightA, J rightB, double otherwise) const {
    return 0.5 * (between(leftA, leftB, otherwise) + between(rightA, rightB, otherwise));
  }
  /// Height of the shoulders above the torso, measured along the trunk [m].
  [[nodiscard]] double shouldersOverTorso(double otherwise) const {
    const auto height = [](const SkeletonFrame& frame) -> std::optional<double> {
      const Vec3 torso = frame[J::kTorso].position, up = frame[J::kNeck].position - torso;
      if (!(up.norm() > 0.05)) return std::nullopt;
      return (middleOf(frame, J::kLeftShoulder, J::kRightShoulder) - torso).dot(up.normalized());
    };
    return median({J::kTorso, J::kNeck, J::kLeftShoulder, J::kRightShoulder}, height, otherwise);
  }
  [[nodiscard]] double lowestFoot() const {
    double lowest = kInfinity;
    for (const SkeletonFrame& frame : frames_) {
      for (const J foot : {J::kLeftFoot, J::kRightFoot}) {
        if (seen(frame, {foot})) lowest = std::min(lowest, frame[foot].position.y());
      }
    }
    return std::isfinite(lowest) ? lowest : 0.0;
  }

 private:
  static double atLeast(double length) { return std::clamp(length, 0.01, 10.0); }

  /// The median of a measure over the frames that show some joints.
  template <typename Measure>
  [[nodiscard]] double median(std::initializer_list<J> joints, const Measure& measure, double otherwise) const {
    std::vector<double> values;
    for (const SkeletonFrame& frame : frames_) {
      if (!seen(frame, joints)) continue;
      if (const std::optional<double> value = measure(frame)) values.push_back(*value);
    }
    if (values.empty()) return otherwise;
    const auto middle = values.begin() + countOf(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  const std::vector<SkeletonFrame>& frames_;
};

/// A T-pose that faces +Z. The root is the middle of the hips; the other joints have the names of the tracked joints.
Result<Skeleton> skeletonFrom(const Lengths& lengths) {
  std::vector<Joint> joints;
  const auto add = [&](std::string_view name, JointIndex parent, B bone, const Vec3& offset) {
    Joint joint;
    joint.name = std::string(name);
    joint.parent = parent;
    joint.bone = bone;
    joint.rest.translation = offset;
    joints.push_back(std::move(joint));
    return static_cast<JointIndex>(joints.size()) - 1;
  };
  const double thigh = lengths.ofBoth(J::kLeftHip, J::kLeftKnee, J::kRightHip, J::kRightKnee, 0.42);
  const double shin = lengths.ofBoth(J::kLeftKnee, J::kLeftFoot, J::kRightKnee, J::kRightFoot, 0.40);
  const double upperArm = lengths.ofBoth(J::kLeftShoulder, J::kLeftElbow, J::kRightShoulder, J::kRightElbow, 0.28);
  const double forearm = lengths.ofBoth(J::kLeftElbow, J::kLeftHand, J::kRightElbow, J::kRightHand, 0.25);
  const double waist = lengths.fromMiddle(J::kLeftHip, J::kRightHip, J::kTorso, 0.25);
  const double chest = lengths.between(J::kTorso, J::kNeck, 0.27);
  const double ankle = std::clamp(lengths.lowestFoot(), 0.03, 0.15);

  const JointIndex hips = add("hips", kNoJoint, B::kHips, {0.0, ankle + thigh + shin, 0.0});
  const JointIndex torso = add(nameOf(J::kTorso), hips, B::kSpine, {0.0, waist, 0.0});
  const JointIndex neck = add(nameOf(J::kNeck), torso, B::kNeck, {0.0, chest, 0.0});
  add(nameOf(J::kHead), neck, B::kHead, {0.0, lengths.between(J::kNeck, J::kHead, 0.15), 0.0});
  const double shoulderHeight = std::clamp(lengths.shouldersOverTorso(chest), 0.0, 2.0 * chest);
  const double halfShoulders = 0.5 * lengths.between(J::kLeftShoulder, J::kRightShoulder, 0.34);
  const double halfHips = 0.5 * lengths.between(J::kLeftHip, J::kRightHip, 0.18);
  for (std::size_t i = 0; i < kLimbCount; ++i) {
    const LimbBones& limb = limbs()[i];
    const bool leg = i >= kFirstLeg;
    const double m = i % 2 == 0 ? 1.0 : -1.0;
    const Vec3 begin = leg ? Vec3(m * halfHips, 0.0, 0.0) : Vec3(m * halfShoulders, shoulderHeight, 0.0);
    const JointIndex upper = add(nameOf(limb.upperJoint), leg ? hips : torso, limb.upper, begin);
    const JointIndex lower =
        add(nameOf(limb.lowerJoint), upper, limb.lower, leg ? Vec3(0.0, -thigh, 0.0) : Vec3(m * upperArm, 0.0, 0.0));
    add(nameOf(limb.endJoint), lower, limb.end, leg ? Vec3(0.0, -shin, 0.0) : Vec3(m * forearm, 0.0, 0.0));
  }
  return Skeleton::create(std::move(joints));
}

}  // namespace

Result<std::vector<SkeletonFrame>> bodyJointsOf(const SkeletalMotion& motion) {
  LORICA_TRY_DO(checkFrames(motion));
  if (MirroredAxes(motion.skeleton).any()) return bodyJointsOf(straightened(motion));
  const std::string named = "the motion " + motion.name;
  LORICA_TRY(const CompletedSkeleton completed, prefixed(named, CompletedSkeleton::create(motion.skeleton)));
  if (!completed.isWhole()) {
    LORICA_TRY(std::vector<SkeletonFrame> frames, bodyJointsOf(completed.complete(motion)));
    for (SkeletonFrame& frame : frames) {
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        if (!kBoneOfJoint[j]) continue;
        TrackedJoint& joint = frame.joints[j];
        if (!completed.knowsPositionOf(*kBoneOfJoint[j])) joint = {};
        if (!completed.speaksOf(*kBoneOfJoint[j])) {
          joint.orientation.reset();
          joint.confidence *= 0.5;
        }
      }
    }
    return frames;
  }
  LORICA_TRY(HumanRig body, prefixed(named, HumanRig::create(motion.skeleton)));
  const auto has = [&](B bone) { return motion.skeleton.jointOf(bone) != kNoJoint; };
  std::vector<SkeletonFrame> frames(motion.times.size());
  std::array<std::vector<FootPosition>, 2> feet;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    SkeletonFrame& frame = frames[f];
    frame.time = motion.times[f];
    const HumanPose human = body.read(motion.pose(static_cast<int>(f)));
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const std::optional<B> bone = kBoneOfJoint[j];
      if (bone && has(*bone)) frame.joints[j] = {body.positionOf(*bone), human[*bone], 1.0};
    }
    const Vec3 neck = has(B::kNeck)
                          ? body.positionOf(B::kNeck)
                          : Vec3(0.5 * (body.positionOf(B::kLeftUpperArm) + body.positionOf(B::kRightUpperArm)));
    frame[J::kTorso] = {0.5 * (human.middleHip + neck), body.spineTurnsOf(human).back(), 1.0};
    for (std::size_t side = 0; side < 2; ++side) feet[side].push_back(human.foot[side]);
  }
  const double floor = floorUnder(feet, motion.times, body.rig.legLength);
  if (std::abs(floor) < kFloorIsZero) return frames;
  for (SkeletonFrame& frame : frames) {
    for (TrackedJoint& joint : frame.joints) joint.position.y() -= joint.confidence > 0.0 ? floor : 0.0;
  }
  return frames;
}

Result<SkeletalMotion> skeletalMotionOf(const std::vector<SkeletonFrame>& frames) {
  if (frames.empty()) return invalidArgument("found no joint frames, expected at least one");
  SkeletalMotion motion;
  LORICA_TRY(motion.skeleton, skeletonFrom(Lengths(frames)));
  LORICA_TRY(Retargeter retargeter, Retargeter::create(motion.skeleton, {.hold = {}, .plantFeet = false}));
  Pose pose = restPose(motion.skeleton);
  motion.times.reserve(frames.size());
  motion.poses.reserve(frames.size() * pose.size());
  Vec3 middleHip = pose[0].translation;
  for (const SkeletonFrame& frame : frames) {
    retargeter.apply(frame, pose);
    // The retargeter puts feet on the floor; here the body stays at the position where it was seen.
    if (seen(frame, {J::kLeftHip, J::kRightHip})) middleHip = middleOf(frame, J::kLeftHip, J::kRightHip);
    pose[0].translation = middleHip;
    motion.times.push_back(frame.time);
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  return motion;
}

}  // namespace lorica
