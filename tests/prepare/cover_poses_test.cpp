#include "prepare/cover_poses.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "session/session.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

std::vector<SkeletonFrame> firstFrames(SyntheticMotion motion, std::size_t count) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(motion);
  frames.resize(std::min(frames.size(), count));
  return frames;
}

class CoverPosesOf : public testing::Test {
 protected:
  Character character_ = makeMannequin();
  std::size_t jointCount_ = static_cast<std::size_t>(character_.skeleton.jointCount());
  std::vector<std::vector<SkeletonFrame>> recordings_ = {firstFrames(SyntheticMotion::kWalk, 17),
                                                         firstFrames(SyntheticMotion::kPunchAndKick, 30)};

  [[nodiscard]] std::vector<SkeletalMotion> motions() const {
    return performAll(character_.skeleton, recordings_).value();
  }

  /// worldFromModel of every frame in sessions of the recordings.
  std::vector<std::vector<Affine3>> framesOfSessions() {
    const PoseView bindPose{character_.mesh.vertices, static_cast<int>(character_.mesh.vertices.size())};
    const Result<Decomposition> whole = decompose(character_.mesh, bindPose, {.maxParts = 1});
    EXPECT_TRUE(whole.ok());
    std::vector<std::vector<Affine3>> all;
    for (const std::vector<SkeletonFrame>& recording : recordings_) {
      Result<Session> session = Session::create(
          character_, *whole, makeJointPoseSource(character_.skeleton, makeRecordedSource(recording)).value(), World());
      EXPECT_TRUE(session.ok());
      while (*session->step()) {
        std::vector<Affine3>& frame = all.emplace_back(jointCount_);
        for (std::size_t j = 0; j < jointCount_; ++j) {
          frame[j] = session->worldFromJoint()[j] * character_.jointFromModel[j];
        }
      }
    }
    return all;
  }

  /// The joint rotations of a pose, computed from its transforms relative to the bind pose.
  Pose localPose(std::span<const Affine3> worldFromModel) {
    Pose pose = restPose(character_.skeleton);
    const auto worldFromJoint = [&](std::size_t j) {
      return Affine3(worldFromModel[j] * character_.jointFromModel[j].inverse());
    };
    for (std::size_t j = 0; j < jointCount_; ++j) {
      const JointIndex parent = character_.skeleton.joints()[j].parent;
      const Affine3 local =
          parent == kNoJoint ? worldFromJoint(j)
                             : Affine3(worldFromJoint(static_cast<std::size_t>(parent)).inverse() * worldFromJoint(j));
      pose[j].rotation = Quat(Mat3(local.linear()));
    }
    return pose;
  }

  static double difference(std::span<const Affine3> a, std::span<const Affine3> b) {
    double largest = 0.0;
    for (std::size_t j = 0; j < a.size(); ++j) {
      largest = std::max(largest, (a[j].matrix() - b[j].matrix()).cwiseAbs().maxCoeff());
    }
    return largest;
  }
};

TEST_F(CoverPosesOf, HalfAreFramesOfSessionsEvenlyAndHeldOutOnesLieHalfway) {
  const CoverPoses poses = test::valueOf(coverPoses(character_, motions(), 20));
  EXPECT_EQ(poses.randomPoses, 10);
  ASSERT_EQ(poses.sampledView().poseCount(), 20);
  ASSERT_EQ(poses.heldOutView().poseCount(), 20);
  const std::vector<std::vector<Affine3>> frames = framesOfSessions();
  ASSERT_EQ(frames.size(), 47u);
  for (int i = 0; i < 20; ++i) {
    const auto frame = static_cast<std::size_t>(std::floor(i * 46.0 / 19.0 + 0.5));
    const std::span<const Affine3> pose =
        i % 2 == 0 ? poses.sampledView().pose(i / 2) : poses.heldOutView().pose(i / 2);
    EXPECT_LT(difference(pose, frames[frame]), 1e-12) << i;
  }
}

TEST_F(CoverPosesOf, TheOtherHalfAreWithinJointLimitsAndStandAtTheOrigin) {
  const CoverPoses poses = test::valueOf(coverPoses(character_, motions(), 20));
  const auto hips = static_cast<std::size_t>(character_.skeleton.jointOf(HumanBone::kHips));
  const Vec3 bindHips = character_.jointFromModel[hips].inverse().translation();
  for (const BonePoseView view : {poses.sampledView(), poses.heldOutView()}) {
    for (int p = 10; p < 20; ++p) {
      EXPECT_TRUE(withinLimits(character_.skeleton, localPose(view.pose(p)))) << p;
      EXPECT_LT((view.pose(p)[hips] * bindHips - bindHips).norm(), 1e-9) << p;
    }
  }
}

TEST_F(CoverPosesOf, NoPoseIsThereTwiceAndTheSameInputGivesTheSame) {
  const Result<CoverPoses> poses = coverPoses(character_, motions(), 20);
  const Result<CoverPoses> again = coverPoses(character_, motions(), 20);
  ASSERT_TRUE(poses.ok() && again.ok());
  std::vector<std::span<const Affine3>> all;
  for (const BonePoseView view : {poses->sampledView(), poses->heldOutView()}) {
    for (int p = 0; p < view.poseCount(); ++p) all.push_back(view.pose(p));
  }
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) EXPECT_GT(difference(all[a], all[b]), 1e-6) << a << " and " << b;
  }
  for (int p = 0; p < 20; ++p) {
    EXPECT_EQ(difference(poses->sampledView().pose(p), again->sampledView().pose(p)), 0.0);
    EXPECT_EQ(difference(poses->heldOutView().pose(p), again->heldOutView().pose(p)), 0.0);
  }
}

TEST_F(CoverPosesOf, FewFramesAreEachTakenOnce) {
  recordings_ = {firstFrames(SyntheticMotion::kWave, 3)};
  const CoverPoses poses = test::valueOf(coverPoses(character_, motions(), 20));
  EXPECT_EQ(poses.sampledView().poseCount(), 2 + 10);
  EXPECT_EQ(poses.heldOutView().poseCount(), 1 + 10);
  recordings_ = {firstFrames(SyntheticMotion::kWave, 1)};
  EXPECT_EQ(coverPoses(character_, motions(), 20)->sampledView().poseCount(), 1 + 10);
  EXPECT_EQ(coverPoses(character_, motions(), 20)->heldOutView().poseCount(), 10);
}

TEST_F(CoverPosesOf, WhatOneKindCannotGiveTheOtherMakesUpFor) {
  const CoverPoses random = test::valueOf(coverPoses(character_, {}, 20));
  EXPECT_EQ(random.randomPoses, 20);
  EXPECT_EQ(random.sampledView().poseCount(), 20);

  // A root with a rest rotation: the axes of the joint limits are not those of the bones.
  std::vector<Joint> joints(character_.skeleton.joints().begin(), character_.skeleton.joints().end());
  joints.front().rest.rotation = Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  character_.skeleton = *Skeleton::create(joints);
  const CoverPoses recorded = test::valueOf(coverPoses(character_, motions(), 20));
  EXPECT_EQ(recorded.randomPoses, 0);
  EXPECT_EQ(recorded.sampledView().poseCount(), 20);
  EXPECT_EQ(recorded.heldOutView().poseCount(), 20);

  const Result<CoverPoses> neither = coverPoses(character_, {}, 20);
  ASSERT_FALSE(neither.ok());
  EXPECT_NE(neither.error().message.find("no motions"), std::string::npos) << neither.error().message;
}

TEST_F(CoverPosesOf, ACharacterWithoutHumanBonesHasThePosesOfItsMotionsAlone) {
  Joint root;
  root.name = "root";
  character_.skeleton = *Skeleton::create({root});
  const Result<CoverPoses> none = coverPoses(character_, {}, 20);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, ErrorCode::kInvalidArgument);
  const std::vector<SkeletalMotion> rest = {{"rest", character_.skeleton, {0.0}, restPose(character_.skeleton)}};
  character_.jointFromModel = {Affine3::Identity()};
  const CoverPoses one = test::valueOf(coverPoses(character_, rest, 20));
  EXPECT_EQ(one.randomPoses, 0);
  EXPECT_EQ(one.sampledView().poseCount(), 1);
  EXPECT_EQ(one.heldOutView().poseCount(), 0);
}

}  // namespace
}  // namespace lorica
