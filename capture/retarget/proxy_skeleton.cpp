#include "capture/retarget/proxy_skeleton.h"

#include "capture/retarget/human_rig.h"
#include "capture/retarget/proxy_draft.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lorica {
namespace {

/// Local transform of a joint relative to another. Both are given by world rotation, without scale, and world
/// transform.
JointTransform relative(const Quat& parentRotation, const Affine3& worldFromParent, const Quat& rotation,
                        const Affine3& worldFromJoint) {
  JointTransform local;
  local.rotation = (parentRotation.conjugate() * rotation).normalized();
  const Affine3 parentFromJoint = worldFromParent.inverse() * worldFromJoint;
  local.translation = parentFromJoint.translation();
  local.scale = (local.rotation.toRotationMatrix().transpose() * parentFromJoint.linear()).diagonal();
  return local;
}

}  // namespace

std::vector<ProxySkeleton::Foot> ProxySkeleton::longFeet(const ProxyDraft& draft, const RetargetRig& rig,
                                                         std::span<const JointIndex> proxyOf) {
  constexpr double kSlack = 0.01;                                            // of the height
  constexpr std::array<double, 5> kPitches = {-0.7, -0.35, 0.0, 0.35, 0.7};  // [rad]
  std::vector<Foot> feet;
  for (std::size_t side = 0; side < 2; ++side) {
    const JointIndex joint = draft[limbs()[kFirstLeg + side].end];
    if (joint == kNoJoint) continue;
    Foot foot;
    foot.joint = proxyOf[joint];
    foot.level = draft.rotation[joint];
    std::vector<Vec3> reached;
    for (JointIndex j = 0; j < draft.character.skeleton.jointCount(); ++j) {
      if (!draft.isBelowOrSame(j, joint)) continue;
      for (const Vec3& point : solePoints(draft.pointsOf(j))) {
        foot.points.push_back({proxyOf[j], draft.world[j].inverse() * point});
        foot.floor = std::min(foot.floor, point.y());
        reached.push_back(point);
      }
    }
    const JointIndex toes = draft[side == 0 ? HumanBone::kLeftToes : HumanBone::kRightToes];
    const RetargetRig::Sole& sole = rig.sole[side];
    const Affine3& worldFromFoot = draft.world[joint];
    const std::array<Vec3, 3> estimated = {worldFromFoot * sole.heel, worldFromFoot * sole.ball,
                                           (toes == kNoJoint ? worldFromFoot : draft.world[toes]) * sole.tip};
    const Vec3 ankle = draft.position(joint);
    const auto lowest = [&](std::span<const Vec3> points, const Quat& turn) {
      double y = std::numeric_limits<double>::infinity();
      for (const Vec3& point : points) y = std::min(y, (turn * (point - ankle)).y());
      return y;
    };
    const bool reachesBelow = std::any_of(kPitches.begin(), kPitches.end(), [&](double pitch) {
      const Quat turn(Eigen::AngleAxisd(pitch, Vec3::UnitX()));
      return lowest(reached, turn) < lowest(estimated, turn) - kSlack * draft.character.height;
    });
    if (reachesBelow) feet.push_back(std::move(foot));
  }
  return feet;
}

Result<ProxySkeleton> ProxySkeleton::create(const Character& character) {
  MirroredAxes mirrored(character.skeleton);
  if (!mirrored.any()) return createStraight(character);
  LORICA_TRY(ProxySkeleton made, createStraight(straightened(character)));
  const std::size_t count = character.skeleton.jointCount();
  if (made.isOwn()) {
    made.proxyOf_.resize(count);
    std::iota(made.proxyOf_.begin(), made.proxyOf_.end(), 0);
    made.sameParent_.assign(count, true);
    made.hipsParentFromWorld_ = RetargetRig::create(made.skeleton_).value().hipsParentFromWorld;
    made.makeBuffers();
  }
  made.mirrored_ = std::move(mirrored);
  return made;
}

Result<ProxySkeleton> ProxySkeleton::createStraight(const Character& character) {
  ProxySkeleton made;
  made.own_ = character.skeleton;
  const std::size_t ownCount = character.skeleton.jointCount();
  const Result<RetargetRig> own = RetargetRig::create(character.skeleton);
  const auto lacks = [&](HumanBone bone) { return character.skeleton.jointOf(bone) == kNoJoint; };
  bool lacking = lacks(HumanBone::kHips);
  for (const LimbBones& limb : limbs()) lacking = lacking || lacks(limb.upper);
  if (!own && lacking) return own.error();
  ProxyDraft draft(character);
  for (std::size_t i = 0; i < kLimbCount && !own; ++i) {
    if (!draft.complete(i)) return own.error();
  }
  draft.attachStrays();
  made.strays_ = draft.strays;
  const auto attached = [](const Stray& stray) { return stray.on != kNoJoint; };
  if (own && std::none_of(draft.strays.begin(), draft.strays.end(), attached)) {
    std::vector<JointIndex> same(ownCount);
    std::iota(same.begin(), same.end(), 0);
    if (longFeet(draft, *own, same).empty()) {
      made.skeleton_ = character.skeleton;
      return made;
    }
  }

  // The joints in the new order; reattached joints are expressed in their new parents' frames.
  const std::vector<JointIndex> order = parentsFirst(draft.joints);
  std::vector<JointIndex> newIndex(order.size());
  std::vector<Joint> joints;
  joints.reserve(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t j = order[k];
    newIndex[j] = static_cast<JointIndex>(k);
    Joint joint = draft.joints[j];
    const JointIndex parent = joint.parent;
    const bool moved = j >= ownCount || parent != character.skeleton.joint(order[k]).parent;
    if (moved) {
      // Must be invertible both ways: into the new parent now, and back into the old one in each frame.
      const JointIndex before = j < ownCount ? character.skeleton.joint(order[k]).parent : kNoJoint;
      for (const JointIndex above : {parent, before}) {
        if (above == kNoJoint || std::abs(draft.world[above].linear().determinant()) > 1e-18) continue;
        return invalidArgument("the joint {} has zero scale", draft.joints[above].name);
      }
      joint.rest = relative(draft.rotation[parent], draft.world[parent], draft.rotation[j], draft.world[j]);
    }
    if (parent != kNoJoint) joint.parent = newIndex[parent];
    joints.push_back(std::move(joint));
  }
  LORICA_TRY(made.skeleton_, Skeleton::create(std::move(joints)));
  LORICA_TRY(const RetargetRig rig, RetargetRig::create(made.skeleton_));
  made.hipsParentFromWorld_ = rig.hipsParentFromWorld;
  made.substitutes_ = std::move(draft.substitutes);

  made.proxyOf_.assign(newIndex.begin(), newIndex.begin() + static_cast<std::ptrdiff_t>(ownCount));
  made.sameParent_.resize(ownCount);
  for (std::size_t j = 0; j < ownCount; ++j) {
    made.sameParent_[j] = draft.joints[j].parent == character.skeleton.joint(static_cast<JointIndex>(j)).parent;
  }
  const auto isAdded = [&](JointIndex joint) { return joint >= character.skeleton.jointCount(); };
  for (std::size_t i = 0; i < kLimbCount; ++i) {
    const LimbBones& limb = limbs()[i];
    const JointIndex upper = draft[limb.upper];
    const JointIndex lower = draft[limb.lower];
    const JointIndex end = draft[limb.end];
    if (isAdded(lower)) {
      const Vec3 along = draft.position(end) - draft.position(upper);
      made.stiff_.push_back(
          {newIndex[upper], newIndex[lower], newIndex[end], draft.rotation[upper].conjugate() * along.normalized()});
    }
    if (i < kFirstLeg || !(isAdded(lower) || isAdded(end))) continue;
    for (std::size_t j = 0; j < ownCount; ++j) {
      if (!draft.isBelowOrSame(static_cast<JointIndex>(j), upper)) continue;
      for (const Vec3& point : solePoints(draft.pointsOf(static_cast<JointIndex>(j)))) {
        made.soles_.push_back({newIndex[j], draft.world[j].inverse() * point});
      }
    }
  }
  if (made.soles_.empty()) made.feet_ = longFeet(draft, rig, newIndex);
  made.makeBuffers();
  return made;
}

void ProxySkeleton::makeBuffers() {
  shown_ = restPose(skeleton_);
  proxyRotation_.resize(shown_.size());
  worldFromProxy_.resize(shown_.size());
  ownRotation_.resize(own_.joints().size());
  worldFromOwn_.resize(own_.joints().size());
}

/// Fills shown_ and its world transforms.
void ProxySkeleton::stiffen(std::span<const JointTransform> proxyPose) {
  std::copy(proxyPose.begin(), proxyPose.end(), shown_.begin());
  evaluatePose(skeleton_, shown_, proxyRotation_, worldFromProxy_);
  for (const StiffLimb& limb : stiff_) {
    const Vec3 toEnd = worldFromProxy_[limb.end].translation() - worldFromProxy_[limb.upper].translation();
    const Quat upper = proxyRotation_[limb.upper];
    const Vec3 along = upper * limb.along;
    const double length = toEnd.norm();
    const Quat swung =
        length < 1e-9 ? upper : (swingBetween(along, toEnd / length, along.unitOrthogonal()) * upper).normalized();
    const JointIndex parent = skeleton_.joint(limb.upper).parent;
    const Quat above = parent == kNoJoint ? Quat::Identity() : proxyRotation_[parent];
    shown_[limb.upper].rotation = (above.conjugate() * swung).normalized();
    shown_[limb.lower].rotation = skeleton_.joint(limb.lower).rest.rotation;
    const Quat lower = swung * shown_[limb.lower].rotation;
    shown_[limb.end].rotation = (lower.conjugate() * proxyRotation_[limb.end]).normalized();
  }
  if (!stiff_.empty()) evaluatePose(skeleton_, shown_, proxyRotation_, worldFromProxy_);

  levelFeet();
  raiseHips();
}

/// Levels each foot only as far as needed.
void ProxySkeleton::levelFeet() {
  constexpr int kHalvings = 12;
  bool any = false;
  for (const Foot& foot : feet_) {
    const Vec3 ankle = worldFromProxy_[foot.joint].translation();
    const auto isAbove = [&](const Quat& turn) {
      return std::all_of(foot.points.begin(), foot.points.end(), [&](const SolePoint& point) {
        const Vec3 fromAnkle = worldFromProxy_[point.joint] * point.position - ankle;
        return ankle.y() + (turn * fromAnkle).y() >= foot.floor;
      });
    };
    if (isAbove(Quat::Identity())) continue;
    const Quat& current = proxyRotation_[foot.joint];
    const Quat turned = current * foot.level.conjugate();
    Quat heading(turned.w(), 0.0, turned.y(), 0.0);
    if (heading.norm() < 1e-6) continue;  // upside down
    heading.normalize();
    const Quat level = (heading * foot.level * current.conjugate()).normalized();
    double least = 0.0;
    double enough = 1.0;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (least + enough);
      (isAbove(Quat::Identity().slerp(middle, level)) ? enough : least) = middle;
    }
    const JointIndex parent = skeleton_.joint(foot.joint).parent;
    const Quat above = parent == kNoJoint ? Quat::Identity() : proxyRotation_[parent];
    shown_[foot.joint].rotation = (above.conjugate() * Quat::Identity().slerp(enough, level) * current).normalized();
    any = true;
  }
  if (any) evaluatePose(skeleton_, shown_, proxyRotation_, worldFromProxy_);
}

void ProxySkeleton::raiseHips() {
  double lowest = 0.0;
  for (const SolePoint& sole : soles_) lowest = std::min(lowest, (worldFromProxy_[sole.joint] * sole.position).y());
  for (const Foot& foot : feet_) {
    for (const SolePoint& sole : foot.points) {
      lowest = std::min(lowest, (worldFromProxy_[sole.joint] * sole.position).y() - foot.floor);
    }
  }
  if (lowest >= 0.0) return;
  const JointIndex hips = skeleton_.jointOf(HumanBone::kHips);
  shown_[hips].translation += hipsParentFromWorld_.linear() * Vec3(0.0, -lowest, 0.0);
  evaluatePose(skeleton_, shown_, proxyRotation_, worldFromProxy_);
}

void ProxySkeleton::mapBack(std::span<const JointTransform> proxyPose, std::span<JointTransform> pose) {
  LORICA_CHECK(skeleton_.jointCount() == countOf(proxyPose), "the pose must match the proxy skeleton");
  LORICA_CHECK(own_.jointCount() == countOf(pose), "the pose needs one transform per joint of the character");
  if (proxyOf_.empty()) {
    std::copy(proxyPose.begin(), proxyPose.end(), pose.begin());
    return;
  }
  stiffen(proxyPose);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const Joint& joint = own_.joint(static_cast<JointIndex>(j));
    const JointIndex parent = joint.parent;
    const std::size_t proxy = proxyOf_[j];
    const Quat above = parent == kNoJoint ? Quat::Identity() : ownRotation_[parent];
    const Affine3 worldFromParent = parent == kNoJoint ? Affine3::Identity() : worldFromOwn_[parent];
    if (sameParent_[j]) {
      pose[j] = shown_[proxy];
    } else {
      pose[j] = relative(above, worldFromParent, proxyRotation_[proxy], worldFromProxy_[proxy]);
      pose[j].scale = joint.rest.scale;
    }
    ownRotation_[j] = (above * pose[j].rotation).normalized();
    worldFromOwn_[j] = worldFromParent * pose[j].matrix();
  }
  if (mirrored_) mirrored_->exchange(pose);
}

SkeletalMotion ProxySkeleton::mapBack(SkeletalMotion motion) {
  SkeletalMotion carried{std::move(motion.name), mirrored_ ? mirrored_->skeleton() : own_, std::move(motion.times), {}};
  const std::size_t proxyCount = skeleton_.jointCount();
  const std::size_t ownCount = own_.jointCount();
  carried.poses.resize(carried.times.size() * ownCount);
  for (std::size_t f = 0; f < carried.times.size(); ++f) {
    mapBack(std::span(motion.poses).subspan(f * proxyCount, proxyCount),
            std::span(carried.poses).subspan(f * ownCount, ownCount));
  }
  return carried;
}

std::vector<std::string> leftBehind(const Character& character) {
  std::vector<std::string> sentences;
  const Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
  if (!proxy) return sentences;
  for (const ProxySkeleton::Stray& stray : proxy->strays()) {
    if (stray.on != kNoJoint) continue;
    sentences.push_back(
        fmt::format("the joint {} carries a part of the surface, but is not below the hips and near no bone: "
                    "it stays behind when the body moves",
                    character.skeleton.joint(stray.joint).name));
  }
  return sentences;
}

std::vector<JointIndex> parentsOf(const Character& character) {
  const Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
  std::vector<JointIndex> parents;
  if (!proxy || proxy->isOwn()) {
    for (const Joint& joint : character.skeleton.joints()) parents.push_back(joint.parent);
    return parents;
  }
  const Skeleton& skeleton = proxy->skeleton();
  std::vector<JointIndex> ownOf(skeleton.jointCount(), kNoJoint);
  for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) ownOf[proxy->proxyOf(j)] = j;
  for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
    JointIndex above = skeleton.joint(proxy->proxyOf(j)).parent;
    while (above != kNoJoint && ownOf[above] == kNoJoint) above = skeleton.joint(above).parent;
    parents.push_back(above == kNoJoint ? kNoJoint : ownOf[above]);
  }
  return parents;
}

bool canPerform(const Character& character) {
  return ProxySkeleton::create(character).ok();
}

}  // namespace lorica
