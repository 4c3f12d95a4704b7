#include "skinning/skeleton.h"

#include "tests/skinning/random_pose.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace lorica::test {
namespace {

Joint jointNamed(std::string name, JointIndex parent) {
  Joint joint;
  joint.name = std::move(name);
  joint.parent = parent;
  return joint;
}

/// A tree of random shape, sometimes with several roots.
Skeleton randomSkeleton(std::mt19937& random, int jointCount) {
  std::vector<Joint> joints;
  for (int i = 0; i < jointCount; ++i) {
    const auto parent = static_cast<JointIndex>(random() % static_cast<unsigned>(i + 1)) - 1;
    Joint joint = jointNamed(std::to_string(i), parent);
    joint.rest.translation = randomVector(random, 0.5);
    joint.rest.rotation = randomRotation(random);
    joints.push_back(joint);
  }
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  EXPECT_TRUE(skeleton.ok());
  return *skeleton;
}

TEST(HumanBone, NamesRoundTripAndDiffer) {
  std::set<std::string_view> names;
  for (int b = 0; b < kHumanBoneCount; ++b) {
    const auto bone = static_cast<HumanBone>(b);
    names.insert(nameOf(bone));
    EXPECT_EQ(humanBoneNamed(nameOf(bone)), bone) << nameOf(bone);
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kHumanBoneCount));
}

TEST(HumanBone, NamesAreThoseOfVrm) {
  EXPECT_EQ(nameOf(HumanBone::kHips), "hips");
  EXPECT_EQ(nameOf(HumanBone::kUpperChest), "upperChest");
  EXPECT_EQ(nameOf(HumanBone::kLeftUpperArm), "leftUpperArm");
  EXPECT_EQ(nameOf(HumanBone::kRightToes), "rightToes");
  EXPECT_EQ(nameOf(HumanBone::kLeftThumbMetacarpal), "leftThumbMetacarpal");
  EXPECT_EQ(nameOf(HumanBone::kRightLittleDistal), "rightLittleDistal");
}

TEST(HumanBone, UnknownNamesAreNothing) {
  for (const char* name : {"", "Hips", "hips ", "leftEye", "jaw", "left"}) EXPECT_FALSE(humanBoneNamed(name)) << name;
}

TEST(Skeleton, WithoutJointsIsRefused) {
  const Result<Skeleton> skeleton = Skeleton::create({});
  ASSERT_FALSE(skeleton.ok());
  EXPECT_EQ(skeleton.error().code, ErrorCode::kInvalidArgument);
}

TEST(Skeleton, ParentThatDoesNotPrecedeIsRefusedByName) {
  for (const JointIndex parent : {1, 2, 7, -2}) {
    const Result<Skeleton> skeleton =
        Skeleton::create({jointNamed("root", kNoJoint), jointNamed("elbow", parent), jointNamed("hand", 0)});
    ASSERT_FALSE(skeleton.ok()) << parent;
    EXPECT_NE(skeleton.error().message.find("elbow"), std::string::npos) << skeleton.error().message;
    EXPECT_NE(skeleton.error().message.find(std::to_string(parent)), std::string::npos) << skeleton.error().message;
  }
}

TEST(Skeleton, RestThatIsNotARigidNumberIsRefused) {
  std::vector<Joint> joints = {jointNamed("root", kNoJoint), jointNamed("tail", 0)};
  joints[1].rest.translation.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Skeleton::create(joints).ok());
  joints[1].rest.translation.y() = 0.0;
  joints[1].rest.rotation.coeffs().setZero();
  EXPECT_FALSE(Skeleton::create(joints).ok());
  joints[1].rest.rotation.setIdentity();
  EXPECT_TRUE(Skeleton::create(joints).ok());
}

TEST(Skeleton, BoneOfTwoJointsIsRefused) {
  std::vector<Joint> joints = {jointNamed("a", kNoJoint), jointNamed("b", 0)};
  joints[0].bone = HumanBone::kHead;
  joints[1].bone = HumanBone::kHead;
  const Result<Skeleton> skeleton = Skeleton::create(joints);
  ASSERT_FALSE(skeleton.ok());
  EXPECT_NE(skeleton.error().message.find("head"), std::string::npos) << skeleton.error().message;
}

TEST(Skeleton, FindsJointsByBone) {
  std::vector<Joint> joints = {jointNamed("pelvis", kNoJoint), jointNamed("skull", 0)};
  joints[1].bone = HumanBone::kHead;
  const Result<Skeleton> skeleton = Skeleton::create(joints);
  ASSERT_TRUE(skeleton.ok());
  EXPECT_EQ(skeleton->jointOf(HumanBone::kHead), 1);
  EXPECT_EQ(skeleton->jointOf(HumanBone::kHips), kNoJoint);
}

TEST(ForwardKinematics, EqualsProductsFromEachJointUpToItsRoot) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const Skeleton skeleton = randomSkeleton(random, 1 + static_cast<int>(seed) * 3);
    const Pose pose = randomPose(skeleton, random, true);
    std::vector<Affine3> world(pose.size());
    computeWorldFromJoint(skeleton, pose, world);
    for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
      const Mat4 expected = worldFromJointByHand(skeleton, pose, j);
      const double error = (world[j].matrix() - expected).cwiseAbs().maxCoeff();
      EXPECT_LT(error, 1e-11 * (1.0 + expected.cwiseAbs().maxCoeff())) << "seed " << seed << ", joint " << j;
    }
  }
}

TEST(ForwardKinematics, QuarterTurnOfTheElbowMovesTheHandAsDrawn) {
  //  shoulder -- 1 m along x --> elbow -- 1 m along x --> hand; the elbow turns by 90 degrees about z
  std::vector<Joint> joints = {jointNamed("shoulder", kNoJoint), jointNamed("elbow", 0), jointNamed("hand", 1)};
  joints[1].rest.translation = Vec3::UnitX();
  joints[2].rest.translation = Vec3::UnitX();
  const Result<Skeleton> skeleton = Skeleton::create(joints);
  ASSERT_TRUE(skeleton.ok());
  Pose pose = restPose(*skeleton);
  pose[1].rotation = Quat(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5));
  std::vector<Affine3> world(3);
  computeWorldFromJoint(*skeleton, pose, world);
  EXPECT_LT((world[2].translation() - Vec3(1, 1, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace lorica::test
