#include "capture/retarget/proxy_skeleton.h"

#include "capture/retarget/leg_reach.h"
#include "capture/retarget/limb_ends.h"
#include "skinning/humanoid/humanoid_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace lorica {
namespace {

constexpr double kNamedNear = 0.15;  // fraction of the height: max distance of a hand or foot found by name from the
                                     // limb's end
constexpr double kPlacedNear = 0.04;
constexpr double kStrayNear = 0.15;  // fraction of the height: max distance of a stray's mesh from a bone
constexpr std::array<std::string_view, 4> kHandWords = {"hand", "palm", "wrist", "fist"};
constexpr std::array<std::string_view, 3> kFootWords = {"foot", "feet", "ankle"};
constexpr std::array<std::string_view, 3> kToesWords = {"toe", "toes", "ball"};

std::size_t at(JointIndex joint) {
  return static_cast<std::size_t>(joint);
}

bool hasWord(const JointName& name, std::span<const std::string_view> words) {
  return std::any_of(name.words.begin(), name.words.end(), [&](const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  });
}

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

/// A proxy skeleton under construction: the character's joints with their original indices, then the added ones.
struct Draft {
  const Character& character;
  RestMesh mesh;
  std::vector<JointName> names;
  std::vector<Joint> joints;  ///< a parent may come after its child; rest is the original one
  std::vector<Quat> rotation;
  std::vector<Affine3> world;
  std::array<JointIndex, kHumanBoneCount> jointOf{};
  std::vector<ProxySkeleton::Substitute> substitutes;
  std::vector<ProxySkeleton::Stray> strays;

  explicit Draft(const Character& of)
      : character(of),
        mesh(of),
        names(readJointNames(of.skeleton)),
        joints(of.skeleton.joints().begin(), of.skeleton.joints().end()),
        rotation(joints.size()),
        world(joints.size()) {
    evaluatePose(of.skeleton, restPose(of.skeleton), rotation, world);
    for (std::size_t b = 0; b < jointOf.size(); ++b) jointOf[b] = of.skeleton.jointOf(static_cast<HumanBone>(b));
  }

  [[nodiscard]] JointIndex operator[](HumanBone bone) const { return jointOf[static_cast<std::size_t>(bone)]; }
  [[nodiscard]] Vec3 position(JointIndex joint) const { return world[at(joint)].translation(); }

  [[nodiscard]] bool isBelowOrSame(JointIndex joint, JointIndex ancestor) const {
    while (joint != kNoJoint && joint != ancestor) joint = joints[at(joint)].parent;
    return joint == ancestor;
  }

  void name(HumanBone bone, JointIndex joint) {
    jointOf[static_cast<std::size_t>(bone)] = joint;
    joints[at(joint)].bone = bone;
  }

  JointIndex add(HumanBone bone, JointIndex parent, const Vec3& where) {
    const auto joint = static_cast<JointIndex>(joints.size());
    joints.push_back({fmt::format("{} (added)", nameOf(bone)), parent, {}, {}});
    rotation.push_back(rotation[at(parent)]);
    world.push_back(world[at(parent)]);
    world.back().translation() = where;
    name(bone, joint);
    return joint;
  }

  /// The vertices of a joint of the character and of its descendants.
  [[nodiscard]] std::vector<Vec3> pointsBelow(JointIndex top) const {
    std::vector<bool> marked(at(character.skeleton.jointCount()));
    for (std::size_t j = 0; j < marked.size(); ++j) marked[j] = isBelowOrSame(static_cast<JointIndex>(j), top);
    return mesh.pointsOf(marked);
  }

  /// The joint that is a limb's hand or foot although it is attached elsewhere; kNoJoint if there is none.
  [[nodiscard]] JointIndex findEnd(std::size_t limb, JointIndex last, const std::optional<Vec3>& meshEnd) const {
    const bool leg = limb >= kFirstLeg;
    const Side side = limb % 2 == 0 ? Side::kLeft : Side::kRight;
    const JointIndex hips = (*this)[HumanBone::kHips];
    // Without a mesh on the limb, only names are used.
    double nearest = (meshEnd ? kNamedNear : 1.0) * character.height;
    JointIndex found = kNoJoint;
    for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
      if (joints[at(j)].bone || isBelowOrSame(last, j)) continue;
      const JointName& its = names[at(j)];
      const bool named = its.side == side && !isHelper(its) &&
                         hasWord(its, leg ? std::span<const std::string_view>(kFootWords)
                                          : std::span<const std::string_view>(kHandWords));
      const bool outside = !isBelowOrSame(j, hips) || isBelowOrSame(j, last);
      if (!named && !(outside && meshEnd && mesh.carriesVertices(j))) continue;
      const double away = (position(j) - meshEnd.value_or(position(last))).norm();
      if (away > nearest || (!named && away > kPlacedNear * character.height)) continue;
      nearest = away;
      found = j;
    }
    return found;
  }

  /// Adds the missing bones of one limb. @return whether it succeeded
  bool complete(std::size_t i) {
    const LimbBones& limb = limbs()[i];
    const bool leg = i >= kFirstLeg;
    const JointIndex upper = (*this)[limb.upper];
    const JointIndex last = (*this)[limb.lower] == kNoJoint ? upper : (*this)[limb.lower];
    if (last != upper && !isBelowOrSame(last, upper)) return false;
    JointIndex end = (*this)[limb.end];
    if (end != kNoJoint && isBelowOrSame(end, last) && last != upper) return true;

    std::optional<Vec3> meshEnd;
    if (end == kNoJoint) {
      const std::vector<Vec3> points = pointsBelow(last);
      meshEnd = leg ? legEnd(points, position(last), (position(last) - position(upper)).norm())
                    : armEnd(points, position(last));
      end = findEnd(i, last, meshEnd);
      if (end != kNoJoint) {
        name(limb.end, end);
        if (leg) nameToes(i == kFirstLeg ? HumanBone::kLeftToes : HumanBone::kRightToes, end);
      }
    } else if (isBelowOrSame(last, end)) {
      return false;
    }
    if (end == kNoJoint && !meshEnd) return false;
    const Vec3 endPosition = end == kNoJoint ? *meshEnd : position(end);
    JointIndex lower = last;
    if (last == upper) {
      lower = add(limb.lower, upper, 0.5 * (position(upper) + endPosition));
      substitutes.push_back({limb.lower, kNoJoint, upper});
    }
    if (end == kNoJoint) {
      add(limb.end, lower, endPosition);
      substitutes.push_back({limb.end, kNoJoint, last});
    } else if (!isBelowOrSame(end, lower)) {
      if (!isBelowOrSame(end, last)) substitutes.push_back({limb.end, end, last});
      joints[at(end)].parent = lower;
    }
    return true;
  }

  void nameToes(HumanBone toes, JointIndex foot) {
    if ((*this)[toes] != kNoJoint) return;
    for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
      if (j == foot || joints[at(j)].bone || isHelper(names[at(j)])) continue;
      if (!isBelowOrSame(j, foot) || !hasWord(names[at(j)], kToesWords)) continue;
      name(toes, j);
      return;
    }
  }

  /// The bone whose line to the next one passes nearest to a point; kNoJoint if none is near.
  [[nodiscard]] JointIndex nearestBone(const Vec3& point) const {
    double nearest = kStrayNear * character.height;
    JointIndex found = kNoJoint;
    for (std::size_t b = 0; b <= static_cast<std::size_t>(HumanBone::kRightHand); ++b) {
      const JointIndex bone = jointOf[b];
      if (bone == kNoJoint) continue;
      double away = (point - position(bone)).norm();
      for (std::size_t next = 0; next <= static_cast<std::size_t>(HumanBone::kRightHand); ++next) {
        if (jointOf[next] == kNoJoint || joints[at(jointOf[next])].parent != bone) continue;
        const Vec3 line = position(jointOf[next]) - position(bone);
        const double along = std::clamp(line.dot(point - position(bone)) / line.squaredNorm(), 0.0, 1.0);
        if (std::isfinite(along)) away = std::min(away, (point - position(bone) - along * line).norm());
      }
      // Of bones that meet at the nearest point, the one farther from the hips.
      const bool better = away < nearest - 1e-9 || (away <= nearest + 1e-9 && isBelowOrSame(bone, found));
      if (!better) continue;
      nearest = away;
      found = bone;
    }
    return found;
  }

  /// Attaches joints that carry vertices but do not move with the hips to their nearest bones, with all below them.
  void attachStrays() {
    const JointIndex hips = (*this)[HumanBone::kHips];
    for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
      if (!mesh.carriesVertices(j) || isBelowOrSame(j, hips)) continue;
      if (isBelowOrSame(hips, j)) {
        strays.push_back({j, kNoJoint});
        continue;
      }
      std::vector<bool> only(at(character.skeleton.jointCount()), false);
      only[at(j)] = true;
      const std::vector<Vec3> points = mesh.pointsOf(only);
      Vec3 middle = Vec3::Zero();
      for (const Vec3& point : points) middle += point / static_cast<double>(points.size());
      const JointIndex bone = nearestBone(middle);
      strays.push_back({j, bone});
      if (bone != kNoJoint) joints[at(j)].parent = bone;
    }
  }

  /// Joint order: parents before children, otherwise unchanged; and the new index of each joint.
  [[nodiscard]] std::vector<JointIndex> order() const {
    std::vector<JointIndex> ordered;
    ordered.reserve(joints.size());
    std::vector<bool> placed(joints.size(), false);
    std::vector<JointIndex> above;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      for (auto up = static_cast<JointIndex>(j); up != kNoJoint && !placed[at(up)]; up = joints[at(up)].parent) {
        above.push_back(up);
        placed[at(up)] = true;
      }
      ordered.insert(ordered.end(), above.rbegin(), above.rend());
      above.clear();
    }
    return ordered;
  }
};

}  // namespace

Result<ProxySkeleton> ProxySkeleton::create(const Character& character) {
  ProxySkeleton made;
  made.own_ = character.skeleton;
  const auto ownCount = at(character.skeleton.jointCount());
  const Result<RetargetRig> own = RetargetRig::create(character.skeleton);
  const auto lacks = [&](HumanBone bone) { return character.skeleton.jointOf(bone) == kNoJoint; };
  bool lacking = lacks(HumanBone::kHips);
  for (const LimbBones& limb : limbs()) lacking = lacking || lacks(limb.upper);
  if (!own && lacking) return own.error();
  Draft draft(character);
  for (std::size_t i = 0; i < kLimbCount && !own; ++i) {
    if (!draft.complete(i)) return own.error();
  }
  draft.attachStrays();
  made.strays_ = draft.strays;
  const auto attached = [](const Stray& stray) { return stray.on != kNoJoint; };
  if (own && std::none_of(draft.strays.begin(), draft.strays.end(), attached)) {
    made.skeleton_ = character.skeleton;
    return made;
  }

  // The joints in the new order; reattached joints are expressed in their new parents' frames.
  const std::vector<JointIndex> order = draft.order();
  std::vector<JointIndex> newIndex(order.size());
  std::vector<Joint> joints;
  joints.reserve(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t j = at(order[k]);
    newIndex[j] = static_cast<JointIndex>(k);
    Joint joint = draft.joints[j];
    const JointIndex parent = joint.parent;
    const bool moved = j >= ownCount || parent != character.skeleton.joint(order[k]).parent;
    if (moved) {
      // Must be invertible both ways: into the new parent now, and back into the old one in each frame.
      const JointIndex before = j < ownCount ? character.skeleton.joint(order[k]).parent : kNoJoint;
      for (const JointIndex above : {parent, before}) {
        if (above == kNoJoint || std::abs(draft.world[at(above)].linear().determinant()) > 1e-18) continue;
        return Error{ErrorCode::kInvalidArgument,
                     fmt::format("the joint {} has zero scale", draft.joints[at(above)].name)};
      }
      joint.rest = relative(draft.rotation[at(parent)], draft.world[at(parent)], draft.rotation[j], draft.world[j]);
    }
    if (parent != kNoJoint) joint.parent = newIndex[at(parent)];
    joints.push_back(std::move(joint));
  }
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  if (!skeleton) return skeleton.error();
  const Result<RetargetRig> rig = RetargetRig::create(*skeleton);
  if (!rig) return rig.error();
  made.skeleton_ = std::move(*skeleton);
  made.hipsParentFromWorld_ = rig->hipsParentFromWorld;
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
      made.stiff_.push_back({newIndex[at(upper)], newIndex[at(lower)], newIndex[at(end)],
                             draft.rotation[at(upper)].conjugate() * along.normalized()});
    }
    if (i < kFirstLeg || !(isAdded(lower) || isAdded(end))) continue;
    for (std::size_t j = 0; j < ownCount; ++j) {
      if (!draft.isBelowOrSame(static_cast<JointIndex>(j), upper)) continue;
      std::vector<bool> only(ownCount, false);
      only[j] = true;
      for (const Vec3& point : solePoints(draft.mesh.pointsOf(only))) {
        made.soles_.push_back({newIndex[j], draft.world[j].inverse() * point});
      }
    }
  }
  made.shown_ = restPose(made.skeleton_);
  made.proxyRotation_.resize(order.size());
  made.worldFromProxy_.resize(order.size());
  made.ownRotation_.resize(ownCount);
  made.worldFromOwn_.resize(ownCount);
  return made;
}

/// Fills shown_ and its world transforms.
void ProxySkeleton::stiffen(std::span<const JointTransform> proxyPose) {
  std::copy(proxyPose.begin(), proxyPose.end(), shown_.begin());
  evaluatePose(skeleton_, shown_, proxyRotation_, worldFromProxy_);
  for (const StiffLimb& limb : stiff_) {
    const Vec3 toEnd = worldFromProxy_[at(limb.end)].translation() - worldFromProxy_[at(limb.upper)].translation();
    const Quat upper = proxyRotation_[at(limb.upper)];
    const Vec3 along = upper * limb.along;
    const double length = toEnd.norm();
    const Quat swung =
        length < 1e-9 ? upper : (swingBetween(along, toEnd / length, along.unitOrthogonal()) * upper).normalized();
    const JointIndex parent = skeleton_.joint(limb.upper).parent;
    const Quat above = parent == kNoJoint ? Quat::Identity() : proxyRotation_[at(parent)];
    shown_[at(limb.upper)].rotation = (above.conjugate() * swung).normalized();
    shown_[at(limb.lower)].rotation = skeleton_.joint(limb.lower).rest.rotation;
    const Quat lower = swung * shown_[at(limb.lower)].rotation;
    shown_[at(limb.end)].rotation = (lower.conjugate() * proxyRotation_[at(limb.end)]).normalized();
  }
  if (!stiff_.empty()) evaluatePose(skeleton_, shown_, proxyRotation_, worldFromProxy_);

  double lowest = 0.0;
  for (const SolePoint& sole : soles_) {
    lowest = std::min(lowest, (worldFromProxy_[at(sole.joint)] * sole.position).y());
  }
  if (lowest < 0.0) {
    const JointIndex hips = skeleton_.jointOf(HumanBone::kHips);
    shown_[at(hips)].translation += hipsParentFromWorld_.linear() * Vec3(0.0, -lowest, 0.0);
    evaluatePose(skeleton_, shown_, proxyRotation_, worldFromProxy_);
  }
}

void ProxySkeleton::mapBack(std::span<const JointTransform> proxyPose, std::span<JointTransform> pose) {
  LORICA_CHECK(at(skeleton_.jointCount()) == proxyPose.size(), "the pose must match the proxy skeleton");
  LORICA_CHECK(at(own_.jointCount()) == pose.size(), "the pose needs one transform per joint of the character");
  if (proxyOf_.empty()) {
    std::copy(proxyPose.begin(), proxyPose.end(), pose.begin());
    return;
  }
  stiffen(proxyPose);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const Joint& joint = own_.joint(static_cast<JointIndex>(j));
    const JointIndex parent = joint.parent;
    const std::size_t proxy = at(proxyOf_[j]);
    const Quat above = parent == kNoJoint ? Quat::Identity() : ownRotation_[at(parent)];
    const Affine3 worldFromParent = parent == kNoJoint ? Affine3::Identity() : worldFromOwn_[at(parent)];
    if (sameParent_[j]) {
      pose[j] = shown_[proxy];
    } else {
      pose[j] = relative(above, worldFromParent, proxyRotation_[proxy], worldFromProxy_[proxy]);
      pose[j].scale = joint.rest.scale;
    }
    ownRotation_[j] = (above * pose[j].rotation).normalized();
    worldFromOwn_[j] = worldFromParent * pose[j].matrix();
  }
}

SkeletalMotion ProxySkeleton::mapBack(SkeletalMotion motion) {
  SkeletalMotion carried{std::move(motion.name), own_, std::move(motion.times), {}};
  const auto proxyCount = at(skeleton_.jointCount());
  const auto ownCount = at(own_.jointCount());
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

bool canPerform(const Character& character) {
  return ProxySkeleton::create(character).ok();
}

}  // namespace lorica
