#include "capture/retarget/completed_skeleton.h"

#include "capture/retarget/proxy_draft.h"
#include "capture/retarget/retarget_rig.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lorica {
namespace {

using B = HumanBone;

// Adult proportions [m].
constexpr double kThigh = 0.42;
constexpr double kShin = 0.42;
constexpr double kUpperArm = 0.28;
constexpr double kForearm = 0.25;
constexpr double kHipHalfWidth = 0.09;
constexpr double kShoulderHalfWidth = 0.18;
constexpr double kShoulderDrop = 0.04;   // below the neck
constexpr double kHipsBelowSpine = 0.1;  // below the lowest bone of the spine
constexpr double kTrunk = 0.5;

/// Bones shorter than this have no direction [m].
constexpr double kShortestJoined = 1e-3;

double sideOf(std::size_t limb) {
  return limb % 2 == 0 ? 1.0 : -1.0;
}

/// A completed skeleton under construction.
struct Draft : SkeletonDraft {
  using SkeletonDraft::position;
  using SkeletonDraft::SkeletonDraft;

  Vec3 up = Vec3::UnitY();
  Vec3 left = Vec3::UnitX();
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
  double size = 1.0;  ///< relative to an adult

  [[nodiscard]] bool has(B bone) const { return (*this)[bone] != kNoJoint; }
  [[nodiscard]] Vec3 position(B bone) const { return position((*this)[bone]); }

  /// Whether a bone descends from another and is not of zero length.
  [[nodiscard]] bool hangsOn(B bone, B above) const {
    return has(bone) && has(above) && isBelowOrSame((*this)[bone], (*this)[above]) &&
           (position(bone) - position(above)).norm() >= kShortestJoined;
  }

  void forget(B bone) {
    JointIndex& joint = jointOf[ordinalOf(bone)];
    if (joint != kNoJoint) joints[joint].bone.reset();
    joint = kNoJoint;
  }

  JointIndex add(B bone, JointIndex parent, const Vec3& where) {
    const auto joint = static_cast<JointIndex>(joints.size());
    JointTransform rest;
    rest.translation = parent == kNoJoint ? where : Vec3(world[parent].inverse() * where);
    rotation.push_back(parent == kNoJoint ? Quat::Identity() : rotation[parent]);
    world.push_back(parent == kNoJoint ? Affine3::Identity() : world[parent]);
    world.back().translation() = where;
    joints.push_back({fmt::format("{} (added)", nameOf(bone)), parent, rest, bone});
    jointOf[ordinalOf(bone)] = joint;
    return joint;
  }

  [[nodiscard]] JointIndex firstOf(std::initializer_list<B> bones) const {
    for (const B bone : bones) {
      if (has(bone)) return (*this)[bone];
    }
    return kNoJoint;
  }
  [[nodiscard]] JointIndex lowestSpine() const { return firstOf({B::kSpine, B::kChest, B::kUpperChest}); }
  [[nodiscard]] JointIndex highestSpine() const { return firstOf({B::kUpperChest, B::kChest, B::kSpine}); }

  /// Determines the up and left directions and the body's size. @return false if they are unknown
  [[nodiscard]] bool measure(const std::array<bool, kLimbCount>& known) {
    double sizes = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < kLimbCount; ++i) {
      if (!known[i]) continue;
      const double length = (position(limbs()[i].lower) - position(limbs()[i].upper)).norm();
      sizes += length / (i < kFirstLeg ? kUpperArm : kThigh);
      ++count;
    }
    if (count == 0) return false;
    size = sizes / count;

    const auto middleOf = [&](std::size_t limb) -> std::optional<Vec3> {
      if (known[limb] && known[limb + 1]) {
        return Vec3(0.5 * (position(limbs()[limb].upper) + position(limbs()[limb + 1].upper)));
      }
      return std::nullopt;
    };
    const JointIndex trunk = has(B::kHips) ? (*this)[B::kHips] : lowestSpine();
    low = position(trunk);
    const std::optional<Vec3> shoulders = middleOf(0);
    const JointIndex neck = firstOf({B::kNeck, B::kHead});
    const std::optional<Vec3> top = neck != kNoJoint ? std::optional<Vec3>(position(neck)) : shoulders;
    if (top && (*top - low).norm() >= kShortestJoined) up = (*top - low).normalized();
    high = top.value_or(Vec3(low + kTrunk * size * up));

    Vec3 across = Vec3::Zero();
    for (const std::size_t limb : {std::size_t{kFirstLeg}, std::size_t{0}}) {
      if (across.norm() < kShortestJoined && middleOf(limb)) {
        across = position(limbs()[limb].upper) - position(limbs()[limb + 1].upper);
      }
    }
    for (std::size_t limb = 0; limb < kLimbCount && across.norm() < kShortestJoined; ++limb) {
      if (known[limb]) across = sideOf(limb) * (position(limbs()[limb].upper) - low);
    }
    across -= across.dot(up) * up;
    if (across.norm() < kShortestJoined) return false;
    left = across.normalized();
    return true;
  }

  void addHips() {
    const JointIndex hips = add(B::kHips, kNoJoint, low - kHipsBelowSpine * size * up);
    const Affine3 hipsFromWorld = world[hips].inverse();
    for (JointIndex j = 0; j < hips; ++j) {
      if (joints[j].parent != kNoJoint) continue;
      joints[j].parent = hips;
      joints[j].rest.translation = hipsFromWorld * joints[j].rest.translation;
    }
  }

  void addSpine() {
    const JointIndex hips = (*this)[B::kHips];
    const JointIndex spine = add(B::kSpine, hips, position(hips));
    const auto carries = [&](JointIndex joint, std::initializer_list<B> bones) {
      return std::any_of(bones.begin(), bones.end(),
                         [&](B bone) { return has(bone) && isBelowOrSame((*this)[bone], joint); });
    };
    for (JointIndex j = 0; j < spine; ++j) {
      if (joints[j].parent != hips || carries(j, {B::kLeftUpperLeg, B::kRightUpperLeg})) continue;
      if (!carries(j, {B::kNeck, B::kHead, B::kLeftShoulder, B::kRightShoulder, B::kLeftUpperArm, B::kRightUpperArm})) {
        continue;
      }
      joints[j].parent = spine;
    }
  }

  void addLimb(std::size_t i) {
    const LimbBones& limb = limbs()[i];
    const bool leg = i >= kFirstLeg;
    for (const B bone : {limb.upper, limb.lower, limb.end}) forget(bone);
    const Vec3 along = leg ? Vec3(-up) : Vec3(sideOf(i) * left);
    const Vec3 begin = leg ? Vec3(position(B::kHips) + sideOf(i) * kHipHalfWidth * size * left)
                           : Vec3(high - size * kShoulderDrop * up + sideOf(i) * kShoulderHalfWidth * size * left);
    const double upper = size * (leg ? kThigh : kUpperArm);
    const double lower = size * (leg ? kShin : kForearm);
    JointIndex joint = add(limb.upper, leg ? (*this)[B::kHips] : highestSpine(), begin);
    joint = add(limb.lower, joint, begin + upper * along);
    add(limb.end, joint, begin + (upper + lower) * along);
  }

  void addEnd(const LimbBones& limb) {
    forget(limb.end);
    const JointIndex lower = (*this)[limb.lower];
    JointIndex only = kNoJoint;
    int children = 0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (joints[j].parent != lower) continue;
      only = static_cast<JointIndex>(j);
      ++children;
    }
    const bool known =
        children == 1 && !joints[only].bone && (position(only) - position(lower)).norm() >= kShortestJoined;
    add(limb.end, lower, known ? position(only) : Vec3(2.0 * position(lower) - position(limb.upper)));
  }
};

}  // namespace

Result<CompletedSkeleton> CompletedSkeleton::create(const Skeleton& skeleton) {
  CompletedSkeleton made;
  made.skeleton_ = skeleton;
  const Result<RetargetRig> own = RetargetRig::create(skeleton);
  if (own) return made;
  Draft draft(skeleton);
  for (const Affine3& world : draft.world) {
    if (!(std::abs(world.linear().determinant()) > 1e-18)) return own.error();
  }
  std::array<bool, kLimbCount> known{};
  for (std::size_t i = 0; i < kLimbCount; ++i) known[i] = draft.hangsOn(limbs()[i].lower, limbs()[i].upper);
  const bool trunk = draft.has(B::kHips) || draft.lowestSpine() != kNoJoint;
  if (!trunk || !draft.measure(known)) return own.error();

  made.trunk_ = draft.has(B::kHips) ? draft[B::kHips] : draft.lowestSpine();
  const bool addsHips = !draft.has(B::kHips);
  if (addsHips) draft.addHips();
  if (draft.lowestSpine() == kNoJoint) draft.addSpine();
  for (std::size_t i = 0; i < kLimbCount; ++i) {
    const LimbBones& limb = limbs()[i];
    if (!known[i]) {
      draft.addLimb(i);
      for (const B bone : {limb.upper, limb.lower, limb.end}) {
        made.silent_[ordinalOf(bone)] = made.placeless_[ordinalOf(bone)] = true;
      }
    } else if (!draft.hangsOn(limb.end, limb.lower)) {
      draft.addEnd(limb);
      made.silent_[ordinalOf(limb.end)] = true;
    }
  }

  const std::vector<JointIndex> order = parentsFirst(draft.joints);
  std::vector<JointIndex> newIndex(order.size());
  std::vector<Joint> joints;
  joints.reserve(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    newIndex[order[k]] = static_cast<JointIndex>(k);
    Joint joint = draft.joints[order[k]];
    if (joint.parent != kNoJoint) joint.parent = newIndex[joint.parent];
    joints.push_back(std::move(joint));
  }
  LORICA_TRY(made.skeleton_, Skeleton::create(std::move(joints)));
  // Adding bones cannot fix other errors, for example limbs that do not descend from the hips.
  if (!RetargetRig::create(made.skeleton_)) return own.error();
  made.indexOf_.assign(newIndex.begin(), newIndex.begin() + skeleton.jointCount());
  if (addsHips) made.addedHips_ = made.skeleton_.jointOf(B::kHips);
  return made;
}

SkeletalMotion CompletedSkeleton::complete(const SkeletalMotion& motion) const {
  if (isWhole()) return motion;
  LORICA_CHECK(countOf(indexOf_) == motion.skeleton.jointCount(), "the motion must match the skeleton");
  SkeletalMotion out{motion.name, skeleton_, motion.times, {}};
  const Pose rest = restPose(skeleton_);
  out.poses.reserve(motion.times.size() * rest.size());
  std::vector<Affine3> world(indexOf_.size());
  Vec3 start = Vec3::Zero();
  for (int f = 0; f < motion.frameCount(); ++f) {
    Pose pose = rest;
    const std::span<const JointTransform> from = motion.pose(f);
    for (std::size_t j = 0; j < indexOf_.size(); ++j) pose[indexOf_[j]] = from[j];
    if (addedHips_ != kNoJoint) {
      computeWorldFromJoint(motion.skeleton, from, world);
      const Vec3 position = world[trunk_].translation();
      if (f == 0) start = position;
      JointTransform& hips = pose[addedHips_];
      hips.translation += Vec3(position.x() - start.x(), 0.0, position.z() - start.z());
      for (std::size_t j = 0; j < indexOf_.size(); ++j) {
        if (motion.skeleton.joint(static_cast<JointIndex>(j)).parent == kNoJoint) {
          pose[indexOf_[j]].translation -= hips.translation;
        }
      }
    }
    out.poses.insert(out.poses.end(), pose.begin(), pose.end());
  }
  return out;
}

Result<void> checkFrames(const SkeletalMotion& motion) {
  const std::size_t joints = motion.skeleton.jointCount();
  if (!motion.times.empty() && motion.poses.size() == motion.times.size() * joints) return {};
  return invalidArgument("the motion {} has {} joint transforms, expected {} frames of {}, and at least one frame",
                         motion.name, motion.poses.size(), motion.times.size(), joints);
}

}  // namespace lorica
