#include "session/pose_source.h"

#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

double difference(std::span<const JointTransform> a, std::span<const JointTransform> b) {
  double largest = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    largest = std::max({largest, (a[j].translation - b[j].translation).norm(), (a[j].scale - b[j].scale).norm(),
                        a[j].rotation.angularDistance(b[j].rotation)});
  }
  return largest;
}

const Skeleton& skeleton() {
  static const Skeleton made = makeMannequin().skeleton;
  return made;
}

std::vector<SkeletonFrame> wave() {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  frames.resize(60);
  return frames;
}

TEST(PoseSource, AMotionIsPlayedFrameByFrameAndThenEndsForGood) {
  const SkeletalMotion motion = perform(skeleton(), wave()).value();
  const std::unique_ptr<PoseSource> source = makeMotionPoseSource(motion);
  Pose pose = restPose(skeleton());
  for (int f = 0; f < motion.frameCount(); ++f) {
    const Result<std::optional<double>> time = source->next(pose);
    ASSERT_TRUE(time.ok() && time->has_value());
    EXPECT_EQ(**time, motion.times[f]);
    EXPECT_EQ(difference(pose, motion.pose(f)), 0.0);
  }
  for (int again = 0; again < 2; ++again) {
    const Result<std::optional<double>> end = source->next(pose);
    ASSERT_TRUE(end.ok());
    EXPECT_FALSE(end->has_value());
    EXPECT_EQ(difference(pose, motion.pose(motion.frameCount() - 1)), 0.0) << "unchanged";
  }
}

TEST(PoseSource, PerformedFramesAreTheRetargetersOwn) {
  const std::vector<SkeletonFrame> frames = wave();
  const SkeletalMotion motion = perform(skeleton(), frames).value();
  ASSERT_EQ(motion.times.size(), frames.size());
  Retargeter retargeter = Retargeter::create(skeleton()).value();
  Pose pose = restPose(skeleton());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    retargeter.apply(frames[f], pose);
    EXPECT_EQ(difference(pose, motion.pose(static_cast<int>(f))), 0.0) << f;
  }
}

TEST(PoseSource, RecordingsOneAfterTheOtherKnowNothingOfEachOther) {
  const std::vector<std::vector<SkeletonFrame>> twice = {wave(), wave()};
  const std::vector<SkeletalMotion> motions = performAll(skeleton(), twice).value();
  ASSERT_EQ(motions.size(), 2u);
  for (int f = 0; f < motions[0].frameCount(); ++f) {
    EXPECT_EQ(difference(motions[0].pose(f), motions[1].pose(f)), 0.0) << f;
  }
}

TEST(PoseSource, AMirroredWaveIsDoneWithTheOtherArm) {
  const auto highest = [](const SkeletalMotion& motion, HumanBone bone) {
    std::vector<Affine3> worldFromJoint(static_cast<std::size_t>(skeleton().jointCount()));
    double top = 0.0;
    for (int f = 0; f < motion.frameCount(); ++f) {
      computeWorldFromJoint(skeleton(), motion.pose(f), worldFromJoint);
      top = std::max(top, worldFromJoint[skeleton().jointOf(bone)].translation().y());
    }
    return top;
  };
  JointSettings mirrored;
  mirrored.mirror = true;
  const SkeletalMotion plain = perform(skeleton(), wave()).value();
  const SkeletalMotion other = perform(skeleton(), wave(), mirrored).value();
  EXPECT_NEAR(highest(plain, HumanBone::kRightHand), highest(other, HumanBone::kLeftHand), 0.02);
  EXPECT_NEAR(highest(plain, HumanBone::kLeftHand), highest(other, HumanBone::kRightHand), 0.02);
  EXPECT_GT(std::abs(highest(plain, HumanBone::kRightHand) - highest(plain, HumanBone::kLeftHand)), 0.3);
}

TEST(PoseSource, JointsCannotPoseASkeletonWithoutHumanBones) {
  Joint root;
  root.name = "root";
  const Result<std::unique_ptr<PoseSource>> source =
      makeJointPoseSource(*Skeleton::create({root}), makeRecordedSource(wave()));
  ASSERT_FALSE(source.ok());
  EXPECT_NE(source.error().message.find("hips"), std::string::npos) << source.error().message;
}

TEST(PoseSource, OnlySmoothedJointsHaveADelay) {
  JointSettings smoothed;
  smoothed.smoothing = OneEuroSettings();
  for (const bool smooth : {false, true}) {
    const std::unique_ptr<PoseSource> source =
        makeJointPoseSource(skeleton(), makeRecordedSource(wave()), smooth ? smoothed : JointSettings()).value();
    Pose pose = restPose(skeleton());
    while (source->next(pose)->has_value()) continue;
    ASSERT_EQ(source->smoothingDelay().has_value(), smooth);
    EXPECT_LT(source->smoothingDelay().value_or(0.0), 0.2);
  }
}

}  // namespace
}  // namespace lorica
