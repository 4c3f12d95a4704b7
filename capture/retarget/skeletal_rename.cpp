#include "capture/retarget/skeletal_retarget.h"

#include "capture/retarget/completed_skeleton.h"
#include "capture/retarget/human_rig.h"
#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace lorica {
namespace {

/// A joint moves if it rotates or translates by more than this relative to the rest pose or the first frame [rad], [m].
constexpr double kStillTurn = 1e-3;
constexpr double kStillShift = 1e-4;
/// Skeletons whose sizes differ by less count as equally large.
constexpr double kSameSize = 0.02;

/// "mixamorig:Hips" is "Hips": exporters prepend the scene name.
std::string_view ownName(std::string_view name) {
  const std::size_t colon = name.rfind(':');
  return colon == std::string_view::npos || colon + 1 == name.size() ? name : name.substr(colon + 1);
}

/// The source joint with the same name for each target joint; kNoJoint if there is none.
std::vector<JointIndex> namesakes(const Skeleton& source, const Skeleton& target) {
  std::map<std::string_view, JointIndex> whole;
  std::map<std::string_view, JointIndex> own;
  for (JointIndex j = 0; j < source.jointCount(); ++j) {
    whole.emplace(source.joint(j).name, j);
    own.emplace(ownName(source.joint(j).name), j);
  }
  std::vector<JointIndex> out;
  out.reserve(target.joints().size());
  for (const Joint& joint : target.joints()) {
    const auto same = whole.find(joint.name);
    const auto similar = own.find(ownName(joint.name));
    out.push_back(same != whole.end() ? same->second : similar != own.end() ? similar->second : kNoJoint);
  }
  return out;
}

std::vector<bool> movingJoints(const SkeletalMotion& motion) {
  const std::span<const Joint> joints = motion.skeleton.joints();
  std::vector<bool> moves(joints.size(), false);
  for (int f = 0; f < motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = motion.pose(f);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      moves[j] = moves[j] || pose[j].rotation.angularDistance(motion.pose(0)[j].rotation) > kStillTurn ||
                 pose[j].rotation.angularDistance(joints[j].rest.rotation) > kStillTurn ||
                 (pose[j].translation - motion.pose(0)[j].translation).norm() > kStillShift;
    }
  }
  return moves;
}

/// World transforms with separate rotations: products of rotations stay rotations whatever the scales are.
struct World {
  std::vector<Affine3> matrix;
  std::vector<Quat> rotation;

  void compute(const Skeleton& skeleton, std::span<const JointTransform> pose) {
    matrix.resize(pose.size());
    rotation.resize(pose.size());
    evaluatePose(skeleton, pose, rotation, matrix);
  }
};

/// Which joints translate relative to their parents, by more than a hundredth of their bone.
std::vector<bool> shiftingJoints(const SkeletalMotion& motion) {
  constexpr double kOfTheBone = 0.01;
  std::vector<bool> shifts(motion.skeleton.joints().size(), false);
  const std::span<const JointTransform> first = motion.pose(0);
  for (int f = 1; f < motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = motion.pose(f);
    for (std::size_t j = 0; j < shifts.size(); ++j) {
      const double shift = (pose[j].translation - first[j].translation).norm();
      shifts[j] = shifts[j] || shift > kOfTheBone * first[j].translation.norm() + 1e-9;
    }
  }
  return shifts;
}

/// Metres per unit of a joint's translation.
double metresAbove(const World& rest, const Skeleton& skeleton, JointIndex joint) {
  const JointIndex parent = skeleton.joint(joint).parent;
  if (parent == kNoJoint) return 1.0;
  return std::max(1e-9, std::cbrt(std::abs(rest.matrix[parent].linear().determinant())));
}

class Renamer {
 public:
  Renamer(const SkeletalMotion& source, const Skeleton& target)
      : source_(source), target_(target), namesake_(namesakes(source.skeleton, target)) {
    for (std::size_t j = 0; j < namesake_.size(); ++j) above_.push_back(namedAbove(static_cast<JointIndex>(j)));
    sourceRest_.compute(source.skeleton, restPose(source.skeleton));
    targetRest_.compute(target, restPose(target));
    sizeRatio_ = sizeRatio();
    shifts_ = shiftingJoints(source);
  }

  [[nodiscard]] Result<void> check() const {
    const std::vector<bool> moves = movingJoints(source_);
    const bool anyMoves = std::find(moves.begin(), moves.end(), true) != moves.end();
    int moving = 0;
    int found = 0;
    for (std::size_t s = 0; s < moves.size(); ++s) {
      if (anyMoves && !moves[s]) continue;
      ++moving;
      if (std::find(namesake_.begin(), namesake_.end(), static_cast<JointIndex>(s)) != namesake_.end()) ++found;
    }
    if (2 * found >= moving) return {};
    return invalidArgument(
        "the motion {}: {} of its {} moving joints match the character by name, expected at least half", source_.name,
        found, moving);
  }

  SkeletalMotion run() {
    SkeletalMotion out;
    out.name = source_.name;
    out.skeleton = target_;
    out.times = source_.times;
    out.poses.reserve(out.times.size() * namesake_.size());
    Pose pose(namesake_.size());
    for (int f = 0; f < source_.frameCount(); ++f) {
      sourcePose_ = source_.pose(f);
      sourceWorld_.compute(source_.skeleton, sourcePose_);
      for (std::size_t j = 0; j < namesake_.size(); ++j) {
        pose[j] = target_.joint(static_cast<JointIndex>(j)).rest;
        if (namesake_[j] != kNoJoint) takeFrom(static_cast<JointIndex>(j), pose);
      }
      out.poses.insert(out.poses.end(), pose.begin(), pose.end());
    }
    return out;
  }

 private:
  /// The nearest matched ancestor whose source joint is an ancestor of this joint's source joint.
  [[nodiscard]] JointIndex namedAbove(JointIndex joint) const {
    if (namesake_[joint] == kNoJoint) return kNoJoint;
    for (JointIndex up = target_.joint(joint).parent; up != kNoJoint; up = target_.joint(up).parent) {
      JointIndex s = namesake_[joint];
      while (s != kNoJoint && s != namesake_[up]) s = source_.skeleton.joint(s).parent;
      if (s != kNoJoint && namesake_[up] != kNoJoint) return up;
    }
    return kNoJoint;
  }

  [[nodiscard]] bool directlyBelow(JointIndex joint) const {
    const JointIndex up = above_[joint];
    return up != kNoJoint && target_.joint(joint).parent == up &&
           source_.skeleton.joint(namesake_[joint]).parent == namesake_[up];
  }

  /// The target's size over the source's, measured on shared joints; 1 if they differ little.
  [[nodiscard]] double sizeRatio() const {
    double target = 0.0;
    double source = 0.0;
    for (std::size_t j = 0; j < namesake_.size(); ++j) {
      if (above_[j] == kNoJoint) continue;
      const auto up = above_[j];
      target += (targetRest_.matrix[j].translation() - targetRest_.matrix[up].translation()).norm();
      source +=
          (sourceRest_.matrix[namesake_[j]].translation() - sourceRest_.matrix[namesake_[up]].translation()).norm();
    }
    if (!(target > 0.0 && source > 0.0) || std::abs(target / source - 1.0) < kSameSize) return 1.0;
    return target / source;
  }

  void takeFrom(JointIndex joint, Pose& pose) const {
    const JointIndex from = namesake_[joint];
    const Joint& mine = target_.joint(joint);
    const JointTransform& rest = source_.skeleton.joint(from).rest;
    JointTransform& local = pose[joint];
    if (directlyBelow(joint)) {
      const JointTransform& theirs = sourcePose_[from];
      local.rotation = theirs.rotation.normalized();
      // A character of other proportions keeps its bone lengths; hips, and joints that translate relative to their
      // parents, take the source's positions. The rest pose of a file with a clip may be any pose of the clip.
      if (mine.bone == HumanBone::kHips || shifts_[from]) {
        const double unit = metresAbove(sourceRest_, source_.skeleton, from) / metresAbove(targetRest_, target_, joint);
        local.translation = sizeRatio_ * unit * theirs.translation;
      }
      local.scale = mine.rest.scale.cwiseProduct(theirs.scale.cwiseQuotient(rest.scale));
      if (!local.scale.allFinite()) local.scale = mine.rest.scale;
      return;
    }
    // One of the skeletons has extra joints in between, or this is the topmost joint: use the transform relative to the
    // shared ancestor, or in the world.
    const JointIndex up = above_[joint];
    Quat rotation = sourceWorld_.rotation[from];
    Vec3 position = sourceWorld_.matrix[from].translation();
    if (up != kNoJoint) {
      const JointIndex theirUp = namesake_[up];
      rotation = sourceWorld_.rotation[theirUp].conjugate() * rotation;
      position = sourceWorld_.rotation[theirUp].conjugate() * (position - sourceWorld_.matrix[theirUp].translation());
    }
    position *= sizeRatio_;
    Affine3 upFromParent = Affine3::Identity();
    Quat upTurn = Quat::Identity();
    for (JointIndex between = mine.parent; between != up; between = target_.joint(between).parent) {
      const JointTransform& step = pose[between];
      upFromParent = step.matrix() * upFromParent;
      upTurn = step.rotation * upTurn;
    }
    // Scales above the ancestor stretch or shrink its axes relative to metres.
    double metres = 1.0;
    for (JointIndex over = up; over != kNoJoint; over = target_.joint(over).parent) {
      metres *= std::cbrt(std::abs(target_.joint(over).rest.scale.prod()));
    }
    if (!(std::abs(upFromParent.linear().determinant()) > 1e-18) || !(metres > 1e-9)) return;
    local.rotation = (upTurn.conjugate() * rotation).normalized();
    local.translation = upFromParent.inverse() * Vec3(position / metres);
  }

  const SkeletalMotion& source_;
  const Skeleton& target_;
  std::vector<JointIndex> namesake_;
  std::vector<JointIndex> above_;  ///< see namedAbove
  World sourceRest_;
  World targetRest_;
  std::vector<bool> shifts_;  ///< of the source's joints, see shiftingJoints
  double sizeRatio_ = 1.0;
  std::span<const JointTransform> sourcePose_;
  World sourceWorld_;
};

}  // namespace

Result<SkeletalMotion> retargetByJointNames(const SkeletalMotion& source, const Skeleton& target) {
  LORICA_TRY_DO(checkFrames(source));
  Renamer renamer(source, target);
  LORICA_TRY_DO(renamer.check());
  return renamer.run();
}

}  // namespace lorica
