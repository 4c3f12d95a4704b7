// What other programs need of a BVH file that Lorica wrote: names that are words and differ, and numbers.
#include "capture/files/bvh_file.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <limits>

namespace lorica {
namespace {

/// A chain of joints, 0.5 m each, at rest.
SkeletalMotion chainOf(const std::vector<std::string>& names) {
  std::vector<Joint> joints;
  for (const std::string& name : names) {
    JointTransform rest;
    rest.translation = Vec3(0.0, 0.5, 0.0);
    joints.push_back({name, static_cast<JointIndex>(joints.size()) - 1, rest, std::nullopt});
  }
  SkeletalMotion motion;
  motion.skeleton = Skeleton::create(std::move(joints)).value();
  motion.times = {0.0};
  motion.poses = restPose(motion.skeleton);
  return motion;
}

TEST(BvhWriter, NamesAreWordsThatDiffer) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> names = {"Hand", "Hand", "Hand_2", "left arm", "left{arm", "", "", "Hand"};
  ASSERT_TRUE(writeBvh(folder.path() / "out.bvh", chainOf(names)));
  const Result<BvhFile> read = readBvh(folder.path() / "out.bvh");
  ASSERT_TRUE(read) << read.error().message;
  std::vector<std::string> found;
  for (const Joint& joint : read->motion.skeleton.joints()) found.push_back(joint.name);
  EXPECT_EQ(found, (std::vector<std::string>{"Hand", "Hand_3", "Hand_2", "left_arm", "left_arm_2", "joint", "joint_2",
                                             "Hand_4"}));
}

TEST(BvhWriter, PosesThatAreNotFiniteAreRefusedWithFrameAndJoint) {
  const test::TemporaryFolder folder;
  SkeletalMotion motion = chainOf({"hips", "spine"});
  motion.times.push_back(0.1);
  const Pose rest = motion.poses;
  motion.poses.insert(motion.poses.end(), rest.begin(), rest.end());
  motion.poses[3].rotation.x() = std::numeric_limits<double>::infinity();
  const Result<void> written = writeBvh(folder.path() / "out.bvh", motion);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("frame 2: the pose of joint 'spine' is not finite"), std::string::npos)
      << written.error().message;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.bvh"));
}

}  // namespace
}  // namespace lorica
