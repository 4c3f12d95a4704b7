#include "capture/retarget/sender_rest.h"

#include "capture/retarget/human_rig.h"

namespace lorica {
namespace {

/// A position nearer to zero than this was not sent [m].
constexpr double kNowhere = 1e-6;

}  // namespace

Result<SenderRest> SenderRest::create(const Skeleton& skeleton) {
  const Result<RetargetRig> rig = RetargetRig::create(skeleton);
  if (!rig) return rig.error();
  const std::vector<Quat> reference = boneReference(*rig);
  SenderRest out;
  for (std::size_t b = 0; b < out.bones_.size(); ++b) {
    const JointIndex joint = skeleton.jointOf(static_cast<HumanBone>(b));
    if (joint == kNoJoint) continue;
    // From the joint above up to the bone above, or to the world.
    Affine3 fromParent = Affine3::Identity();
    Quat turn = Quat::Identity();
    JointIndex above = skeleton.joint(joint).parent;
    while (above != kNoJoint && !skeleton.joint(above).bone) {
      const JointTransform& rest = skeleton.joint(above).rest;
      fromParent = rest.matrix() * fromParent;
      turn = rest.rotation * turn;
      above = skeleton.joint(above).parent;
    }
    const Quat bone = above == kNoJoint ? Quat::Identity() : reference[static_cast<std::size_t>(above)];
    out.bones_[b] =
        Bone{(bone * turn).normalized(), bone * fromParent.translation(),
             reference[static_cast<std::size_t>(joint)].conjugate(), skeleton.joint(joint).rest.translation};
  }
  return out;
}

void SenderRest::apply(BonePose& pose) const {
  for (std::size_t b = 0; b < bones_.size(); ++b) {
    if (!bones_[b] || !pose.rotation[b]) continue;
    const Bone& bone = *bones_[b];
    const Vec3 sent = pose.offset[b].norm() > kNowhere ? pose.offset[b] : bone.rest;
    pose.offset[b] = bone.parentInReference + bone.referenceFromParent * sent;
    pose.rotation[b] = (bone.referenceFromParent * *pose.rotation[b] * bone.jointFromReference).normalized();
  }
}

}  // namespace lorica
