// Skeletons below a negative scale, which mirrors the axes of all joints.
#include "capture/retarget/mirrored_axes.h"

#include "capture/files/joint_csv.h"
#include "capture/retarget/bone_pose.h"
#include "capture/retarget/skeletal_retarget.h"
#include "tests/capture/figures.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lorica {
namespace {

using test::degrees;

Character characterOf(const Skeleton& skeleton) {
  Character character;
  character.skeleton = skeleton;
  character.influenceBegin = {0};
  character.height = 1.6;
  for (const Affine3& world : test::worldOf(skeleton, restPose(skeleton))) {
    character.jointFromModel.push_back(world.inverse());
  }
  return character;
}

/// The same joints below one with this scale.
Skeleton belowScale(const Skeleton& skeleton, const Vec3& scale) {
  std::vector<Joint> joints(1);
  joints[0].name = "mirror";
  joints[0].rest.scale = scale;
  for (Joint joint : skeleton.joints()) {
    ++joint.parent;
    joints.push_back(joint);
  }
  return Skeleton::create(std::move(joints)).value();
}

Skeleton figure() {
  test::FigureSettings settings;
  settings.crookedAxes = true;
  settings.armsDown = degrees(40.0);
  return test::makeFigure(settings).skeleton;
}

SkeletalMotion walk() {
  return skeletalMotionOf(readJointCsv(test::recordingsFolder() / "walk.csv").value()).value();
}

/// Largest distance of a bone from the one on the other side of a plain figure [m].
double distance(const SkeletalMotion& mirrored, const SkeletalMotion& plain, bool otherSides) {
  double largest = 0.0;
  for (int f = 0; f < plain.frameCount(); f += 10) {
    const std::vector<Affine3> a =
        test::worldOf(mirrored.skeleton, Pose(mirrored.pose(f).begin(), mirrored.pose(f).end()));
    const std::vector<Affine3> b = test::worldOf(plain.skeleton, Pose(plain.pose(f).begin(), plain.pose(f).end()));
    for (const Joint& joint : plain.skeleton.joints()) {
      const HumanBone bone = *joint.bone;
      const JointIndex one = mirrored.skeleton.jointOf(otherSides ? otherSide(bone) : bone);
      largest = std::max(largest, (a[one].translation() - b[plain.skeleton.jointOf(bone)].translation()).norm());
    }
  }
  return largest;
}

TEST(MirroredAxes, AMirroredBodyMovesLikeItself) {
  const SkeletalMotion motion = walk();
  const Character plain = characterOf(figure());
  const SkeletalMotion expected = retargetMotion(motion, plain).value();
  for (const Vec3& scale : {Vec3(-1.0, 1.0, 1.0), Vec3(1.0, 1.0, -1.0), Vec3(-1.0, 1.0, -1.0)}) {
    const Character mirrored = characterOf(belowScale(plain.skeleton, scale));
    const Result<SkeletalMotion> performed = retargetMotion(motion, mirrored);
    ASSERT_TRUE(performed) << performed.error().message;
    const bool otherSides = scale.prod() < 0.0;  // left and right were named before it was mirrored
    EXPECT_LT(distance(*performed, expected, otherSides), 1e-6) << scale.transpose();
    // And back, as the source of a motion.
    const Result<SkeletalMotion> back = retargetMotion(*performed, plain);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_LT(distance(*back, expected, false), 0.01) << scale.transpose();
  }
}

TEST(MirroredAxes, BonesThatAreSentAreThoseOfThePlainBody) {
  const Skeleton plain = figure();
  const Skeleton mirrored = belowScale(plain, Vec3(-1.0, 1.0, 1.0));
  Pose pose = restPose(mirrored);
  const JointIndex arm = mirrored.jointOf(HumanBone::kLeftUpperArm);
  pose[arm].rotation = pose[arm].rotation * Quat(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()));
  const BonePose sent = BonePoseReader::create(mirrored).value().read(pose);
  const std::vector<Affine3> world = test::worldOf(mirrored, pose);
  // Positions that follow from what is sent are those of the joints; what was named left is on the right.
  const WorldBones bones = worldOf(sent);
  for (const HumanBone bone : {HumanBone::kLeftHand, HumanBone::kRightHand, HumanBone::kLeftFoot, HumanBone::kHead}) {
    const Vec3 expected = world[mirrored.jointOf(otherSide(bone))].translation();
    EXPECT_LT((bones.position[static_cast<std::size_t>(bone)] - expected).norm(), 1e-9) << nameOf(bone);
  }
}

TEST(MirroredAxes, WithoutNegativeScalesNothingChanges) {
  const Skeleton plain = figure();
  EXPECT_FALSE(MirroredAxes(plain).any());
}

}  // namespace
}  // namespace lorica
