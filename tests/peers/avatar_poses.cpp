#include "tests/peers/avatar_poses.h"

#include "skinning/linear_blend.h"
#include "tests/peers/peer.h"

#include <gtest/gtest.h>

namespace lorica::test {

Pose poseOf(const Character& character, const nlohmann::json& shot) {
  const Skeleton& skeleton = character.skeleton;
  Pose pose = restPose(skeleton);
  std::vector<Affine3> worldFromJoint(pose.size());
  computeWorldFromJoint(skeleton, pose, worldFromJoint);
  std::vector<Quat> worldRotation(pose.size());
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    const JointIndex parent = skeleton.joint(j).parent;
    worldRotation[j] =
        (parent == kNoJoint ? Quat::Identity() : worldRotation[parent]) * skeleton.joint(j).rest.rotation;
  }
  const auto jointNamed = [&](const std::string& name) {
    const std::optional<HumanBone> bone = humanBoneNamed(name);
    const JointIndex joint = bone ? skeleton.jointOf(*bone) : kNoJoint;
    EXPECT_NE(joint, kNoJoint) << "the character has no bone " << name;
    return joint;
  };
  const auto parentRotation = [&](JointIndex j) {
    return skeleton.joint(j).parent == kNoJoint ? Quat::Identity() : worldRotation[skeleton.joint(j).parent];
  };

  if (shot.contains("rotations")) {
    for (const auto& [name, q] : shot["rotations"].items()) {
      const JointIndex j = jointNamed(name);
      if (j == kNoJoint) continue;
      const Quat world = Quat(q.at(3), q.at(0), q.at(1), q.at(2)).normalized();
      pose[j].rotation = parentRotation(j).conjugate() * world * parentRotation(j) * skeleton.joint(j).rest.rotation;
    }
  }
  if (shot.contains("hips")) {
    const JointIndex j = jointNamed("hips");
    const JointIndex parent = j == kNoJoint ? kNoJoint : skeleton.joint(j).parent;
    const Mat3 worldFromParent = parent == kNoJoint ? Mat3(Mat3::Identity()) : Mat3(worldFromJoint[parent].linear());
    if (j != kNoJoint) pose[j].translation += worldFromParent.inverse() * vectorOf(shot["hips"]);
  }
  return pose;
}

std::vector<Vec3> posedVertices(const Character& character, const Pose& pose) {
  std::vector<Affine3> transforms(pose.size());
  computeWorldFromJoint(character.skeleton, pose, transforms);
  computeWorldFromModel(character, transforms, transforms);
  std::vector<Vec3> posed(character.mesh.vertices.size());
  skinLinearBlend(character, transforms, posed);
  return posed;
}

}  // namespace lorica::test
