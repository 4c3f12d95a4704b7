#include "session/pose_source.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "session/joint_trust.h"
#include "session/prepare/read_motion.h"
#include "session/session.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace lorica {
namespace {

using J = BodyJoint;

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
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
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
    const std::optional<double> end = test::valueOf(source->next(pose));
    EXPECT_FALSE(end.has_value());
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
  EXPECT_TRUE(test::has(
      test::errorOf(makeJointPoseSource(*Skeleton::create({root}), makeRecordedSource(wave()))).message, "hips"));
}

TEST(PoseSource, FaultsOutOfRangeAreRefused) {
  const Character mannequin = makeMannequin();
  const auto motion = shippedMotion("walk");
  ASSERT_TRUE(motion);
  for (double FaultSettings::*fault : {&FaultSettings::dropout, &FaultSettings::jitter, &FaultSettings::swap,
                                       &FaultSettings::late, &FaultSettings::freeze}) {
    for (const double wrong : {-0.1, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
      MotionOptions options;
      options.inject.*fault = wrong;
      const auto source = poseSourceOf(mannequin, *motion, options);
      ASSERT_FALSE(source) << wrong;
      EXPECT_EQ(source.error().code, ErrorCode::kInvalidArgument);
      EXPECT_TRUE(test::has(source.error().message, "expected"));
    }
    MotionOptions options;
    options.inject.*fault = 1.0;
    EXPECT_TRUE(poseSourceOf(mannequin, *motion, options));
  }
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

constexpr double kFrame = 1.0 / 30.0;

SkeletonFrame standing(double time) {
  SkeletonFrame frame = shippedFrames("wave").front();
  frame.time = time;
  return frame;
}

double trustOf(const JointTrust& trust, const Skeleton& skeleton, HumanBone bone) {
  return trust.joints()[skeleton.jointOf(bone)];
}

TEST(JointTrust, SeenJointsAreTrustedAndGuessedOnesAreNot) {
  const Skeleton skeleton = makeMannequin().skeleton;
  JointTrust trust(skeleton);
  SkeletonFrame frame = standing(0.0);
  frame[J::kLeftHand].confidence = 0.5;
  frame[J::kRightKnee].confidence = 0.0;
  frame[J::kHead].confidence = 0.65;
  trust.take(frame);
  EXPECT_EQ(trustOf(trust, skeleton, HumanBone::kHips), 1.0);
  EXPECT_EQ(trustOf(trust, skeleton, HumanBone::kLeftUpperArm), 1.0);
  EXPECT_EQ(trustOf(trust, skeleton, HumanBone::kLeftLowerArm), 0.0) << "it ends at the hand";
  EXPECT_EQ(trustOf(trust, skeleton, HumanBone::kLeftIndexDistal), 0.0);
  EXPECT_EQ(trustOf(trust, skeleton, HumanBone::kRightUpperLeg), 0.0);
  EXPECT_EQ(trustOf(trust, skeleton, HumanBone::kRightLowerLeg), 0.0);
  EXPECT_EQ(trustOf(trust, skeleton, HumanBone::kRightFoot), 1.0);
  EXPECT_NEAR(trustOf(trust, skeleton, HumanBone::kHead), 0.5, 1e-12);
}

TEST(JointTrust, AJumpIsNotBelievedAndTrustComesBackIn300Milliseconds) {
  const Skeleton skeleton = makeMannequin().skeleton;
  JointTrust trust(skeleton);
  trust.take(standing(0.0));
  for (int i = 1; i <= 12; ++i) {
    SkeletonFrame frame = standing(i * kFrame);
    frame[J::kRightHand].position += Vec3(2.0, 0.0, 0.0);
    trust.take(frame);
    EXPECT_NEAR(trustOf(trust, skeleton, HumanBone::kRightHand), std::min(1.0, (i - 1) * kFrame / 0.3), 1e-9) << i;
    EXPECT_EQ(trustOf(trust, skeleton, HumanBone::kLeftHand), 1.0);
  }
}

/// The mannequin stands; after a second its right hand moves by 2 m, past many light balls.
/// @return maximum speed of a ball [m/s]
double fastestBall(double confidence, bool smooth) {
  std::vector<SkeletonFrame> frames;
  for (int i = 0; i < 75; ++i) {
    SkeletonFrame frame = standing(i * kFrame);
    // Of the whole arm: a part may hold some of the shoulder, too.
    for (const J joint : {J::kRightShoulder, J::kRightElbow, J::kRightHand}) frame[joint].confidence = confidence;
    // From hanging at the side to pointing straight ahead: in one frame, or in a sixth of a second.
    const double share = i < 30 ? 0.0 : smooth ? std::min(1.0, (i - 29) / 5.0) : 1.0;
    const Vec3 shoulder = frame[J::kRightShoulder].position;
    const double angle = share * 0.6 * EIGEN_PI;
    const Vec3 along(0.0, -std::cos(angle), std::sin(angle));
    frame[J::kRightElbow].position = shoulder + 0.28 * along;
    frame[J::kRightHand].position = shoulder + 0.53 * along + (smooth ? 0.0 : share * 1.5) * along;
    frames.push_back(frame);
  }
  World::Settings weightless;
  weightless.gravity = Vec3::Zero();
  World world(weightless);
  for (int i = 0; i < 12; ++i) {
    Prop ball;
    ball.shape = PropShape::kSphere;
    ball.halfExtents = Vec3::Constant(0.05);
    ball.mass = 0.1;
    ball.worldFromProp.translation() = Vec3(-0.18 + 0.11 * (i % 2 - 0.5), 0.95 + 0.11 * (i / 2), 0.42);
    world.addProp(ball);
  }
  static const Character character = makeMannequin();
  static const Decomposition parts = [] {
    DecomposeSettings settings;
    settings.maxParts = 12;
    const PoseView bind{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
    return decompose(character.mesh, bind, settings).value();
  }();
  std::unique_ptr<PoseSource> source =
      makeJointPoseSource(character.skeleton, makeRecordedSource(std::move(frames))).value();
  Session session = Session::create(character, parts, std::move(source), std::move(world)).value();
  double fastest = 0.0;
  while (session.step().value()) {
    for (const Prop& prop : session.world().props()) fastest = std::max(fastest, prop.velocity.norm());
  }
  return fastest;
}

TEST(JointTrust, AHandThatIsSeenStrikes) {
  EXPECT_GT(fastestBall(1.0, true), 2.0);
}

TEST(JointTrust, AHandThatIsGuessedStrikesNoFasterThanStated) {
  EXPECT_LE(fastestBall(0.5, true), 1.1);
}

TEST(JointTrust, AHandSentTwoMetresAwayInOneFrameThrowsNothing) {
  EXPECT_LE(fastestBall(1.0, false), 1.1);
}

}  // namespace
}  // namespace lorica
