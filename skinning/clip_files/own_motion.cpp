#include "skinning/clip_files/own_motion.h"

#include "geometry/counts.h"

#include <utility>

namespace lorica {

namespace {

/// A rotation after a uniform scale.
struct Similarity {
  Quat rotation = Quat::Identity();
  double scale = 1.0;
};

/// A motion in the space that `outFromFile` maps the file's to.
///
/// With root = rest of the first joint and D = outFromFile * root^-1 * pose of the first joint, a topmost joint of the
/// file becomes D * its pose / outFromFile's scale; below it only translations are scaled.
class RootRemoval {
 public:
  RootRemoval(const Skeleton& skeleton, const Similarity& outFromFile)
      : skeleton_(skeleton), outFromFile_(outFromFile), root_(skeleton.joint(0).rest) {}

  [[nodiscard]] JointTransform convert(JointIndex joint, const JointTransform& local,
                                       const JointTransform& root) const {
    JointTransform out = local;
    if (skeleton_.joint(joint).parent != 0) {
      out.translation *= outFromFile_.scale;
      return out;
    }
    const Quat turn = outFromFile_.rotation * root_.rotation.conjugate();
    const double shrink = root.scale.x() / root_.scale.x();
    const Vec3 shift = root_.rotation.conjugate() * (root.translation - root_.translation) / root_.scale.x();
    const Quat turned = turn * root.rotation;
    out.translation = outFromFile_.scale * (outFromFile_.rotation * shift + turned * (shrink * local.translation));
    out.rotation = (turned * local.rotation).normalized();
    out.scale = shrink * local.scale;
    return out;
  }

 private:
  const Skeleton& skeleton_;
  Similarity outFromFile_;
  JointTransform root_;
};

[[nodiscard]] OwnMotion withoutRoot(const CharacterFile& file, const SkeletalMotion& motion,
                                    const Similarity& outFromFile) {
  const RootRemoval removal(motion.skeleton, outFromFile);
  std::vector<Joint> joints(motion.skeleton.joints().begin() + 1, motion.skeleton.joints().end());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    joints[j].rest = removal.convert(j + 1, joints[j].rest, motion.skeleton.joint(0).rest);
    joints[j].parent = joints[j].parent == 0 ? kNoJoint : joints[j].parent - 1;
  }
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  LORICA_CHECK(skeleton.ok(), "a skeleton without its root is valid");
  OwnMotion own;
  own.nodeOfJoint.assign(file.nodeOfJoint.begin() + 1, file.nodeOfJoint.end());
  own.motion.name = motion.name;
  own.motion.skeleton = std::move(*skeleton);
  own.motion.times = motion.times;
  own.motion.poses.reserve(motion.poses.size() - motion.times.size());
  for (int f = 0; f < motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = motion.pose(f);
    for (std::size_t j = 1; j < pose.size(); ++j) {
      own.motion.poses.push_back(removal.convert(j, pose[j], pose[0]));
    }
  }
  return own;
}

}  // namespace

OwnMotion inFileUnits(const CharacterFile& file, const SkeletalMotion& motion) {
  return withoutRoot(file, motion, {});
}

OwnMotion inMetres(const CharacterFile& file, const SkeletalMotion& motion) {
  const JointTransform& root = motion.skeleton.joint(0).rest;
  return withoutRoot(file, motion, {root.rotation, root.scale.x()});
}

SkeletalMotion withoutCopies(const OwnMotion& own) {
  const Skeleton& all = own.motion.skeleton;
  std::vector<bool> isParent(all.joints().size(), false);  // of one that is kept: children come later
  for (JointIndex j = all.jointCount() - 1; j >= 0; --j) {
    const JointIndex parent = all.joint(j).parent;
    if (parent != kNoJoint && (own.nodeOfJoint[j] != -1 || isParent[j])) isParent[parent] = true;
  }
  std::vector<JointIndex> keptAs(all.joints().size(), kNoJoint);
  std::vector<Joint> joints;
  for (JointIndex j = 0; j < all.jointCount(); ++j) {
    if (own.nodeOfJoint[j] == -1 && !isParent[j]) continue;  // a copy has no children, a sheared node's joint has one
    keptAs[j] = countOf(joints);
    joints.push_back(all.joint(j));
    if (joints.back().parent != kNoJoint) joints.back().parent = keptAs[joints.back().parent];
  }
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  LORICA_CHECK(skeleton.ok(), "a skeleton without some of its leaves is valid");
  SkeletalMotion kept{own.motion.name, std::move(*skeleton), own.motion.times, {}};
  for (int f = 0; f < own.motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = own.motion.pose(f);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      if (keptAs[j] != kNoJoint) kept.poses.push_back(pose[j]);
    }
  }
  return kept;
}

}  // namespace lorica
