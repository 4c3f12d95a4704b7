#include "collision/hulls/keyframes.h"
#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "collision/hulls/cover_choice.h"
#include "geometry/work_budgets.h"
#include "session/pose_source.h"
#include "session/prepare/training_motions.h"
#include "session/session.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

std::vector<SkeletonFrame> firstFrames(std::string_view motion, std::size_t count) {
  std::vector<SkeletonFrame> frames = shippedFrames(motion);
  frames.resize(std::min(frames.size(), count));
  return frames;
}

std::vector<SkeletalMotion> performEach(const Character& character,
                                        std::span<const std::vector<SkeletonFrame>> recordings) {
  std::vector<SkeletalMotion> motions;
  for (const auto& recording : recordings) motions.push_back(perform(character.skeleton, recording).value());
  return motions;
}

class Keyframes : public testing::Test {
 protected:
  Character character_ = makeMannequin();
  std::size_t vertexCount_ = character_.mesh.vertices.size();
  std::vector<std::vector<SkeletonFrame>> recordings_ = {firstFrames("walk", 17), firstFrames("punch_and_kick", 30)};
  std::vector<SkeletalMotion> motions_ = performEach(character_, recordings_);

  /// Index of each keyframe in the concatenated recordings.
  std::vector<int> framesOf(const std::vector<Vec3>& keyframes) {
    std::vector<Vec3> all;
    for (const SkeletalMotion& motion : motions_) {
      const std::vector<Vec3> posed = poseAllFrames(character_, motion);
      all.insert(all.end(), posed.begin(), posed.end());
    }
    std::vector<int> found;
    for (std::size_t k = 0; k * vertexCount_ < keyframes.size(); ++k) {
      for (std::size_t f = 0; f * vertexCount_ < all.size(); ++f) {
        if (std::equal(all.begin() + static_cast<std::ptrdiff_t>(f * vertexCount_),
                       all.begin() + static_cast<std::ptrdiff_t>((f + 1) * vertexCount_),
                       keyframes.begin() + static_cast<std::ptrdiff_t>(k * vertexCount_))) {
          found.push_back(static_cast<int>(f));
          break;
        }
      }
    }
    return found;
  }
};

TEST_F(Keyframes, AreUniformOverTheRecordingsLaidEndToEnd) {
  for (int count : {1, 2, 5, 12, 47}) {
    const std::vector<Vec3> keyframes = test::valueOf(sampleKeyframes(character_, motions_, count));
    ASSERT_EQ(keyframes.size(), static_cast<std::size_t>(count) * vertexCount_);
    std::vector<int> expected;
    for (int k = 0; k < count; ++k) {
      expected.push_back(count == 1 ? 0 : static_cast<int>(std::floor(k * 46.0 / (count - 1) + 0.5)));
    }
    EXPECT_EQ(framesOf(keyframes), expected) << count;
  }
}

TEST_F(Keyframes, MoreThanThereAreFramesIsRefused) {
  const Error keyframes = test::errorOf(sampleKeyframes(character_, motions_, 48));
  EXPECT_EQ(keyframes.code, ErrorCode::kInvalidArgument);
  test::expectAll(keyframes.message, {"48", "47"});
  EXPECT_FALSE(sampleKeyframes(character_, motions_, 0).ok());
  EXPECT_FALSE(sampleKeyframes(character_, {}, 1).ok());
}

TEST_F(Keyframes, ACharacterWithoutHumanBonesIsRefused) {
  Joint root;
  root.name = "root";
  EXPECT_TRUE(test::has(test::errorOf(perform(*Skeleton::create({root}), recordings_.front())).message, "hips"));
}

TEST_F(Keyframes, ChosenOnesAreFramesOfTheRecordingsAndSayWhich) {
  const ChosenKeyframes chosen = test::valueOf(chooseKeyframes(character_, motions_, 6, 0.0));
  ASSERT_EQ(chosen.sources.size(), 6u);
  const std::vector<int> frames = framesOf(chosen.positions);
  ASSERT_EQ(frames.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    const KeyframeSource& source = chosen.sources[k];
    ASSERT_LT(source.motion, 2u);
    ASSERT_LT(source.frame, recordings_[source.motion].size());
    EXPECT_EQ(source.time, recordings_[source.motion][source.frame].time);
    EXPECT_EQ(static_cast<std::size_t>(frames[k]), source.frame + (source.motion == 1 ? 17 : 0));
  }
  EXPECT_EQ(frames.front(), 0) << "the first frame is always a keyframe";
  EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end()));
  EXPECT_EQ(std::adjacent_find(frames.begin(), frames.end()), frames.end());
  EXPECT_GT(chosen.farthest, 0.0);
}

TEST_F(Keyframes, MoreOfThemLeaveNoFrameFartherAway) {
  double before = std::numeric_limits<double>::infinity();
  for (const int count : {1, 2, 4, 8, 16}) {
    const ChosenKeyframes chosen = test::valueOf(chooseKeyframes(character_, motions_, count, 0.0));
    EXPECT_LE(chosen.farthest, before);
    before = chosen.farthest;
  }
  // It stops by itself if all frames are keyframes or no frame is more distant than the limit.
  const ChosenKeyframes all = test::valueOf(chooseKeyframes(character_, motions_, 1000, 0.0));
  EXPECT_LE(all.sources.size(), 47u);
  EXPECT_EQ(all.farthest, 0.0);
  const ChosenKeyframes enough = test::valueOf(chooseKeyframes(character_, motions_, 1000, 0.05));
  EXPECT_LE(enough.farthest, 0.05);
  EXPECT_LT(enough.sources.size(), all.sources.size());
}

TEST_F(Keyframes, WhereTheBodyStandsAndTurnsDoesNotCount) {
  // The same pose at another position, then a different pose at the old position: only the latter is a new keyframe.
  const std::vector<SkeletonFrame> walk = shippedFrames("walk");
  const auto moved = [](SkeletonFrame frame, const Quat& rotation, const Vec3& shift) {
    for (TrackedJoint& joint : frame.joints) {
      joint.position = rotation * joint.position + shift;
      if (joint.orientation) joint.orientation = rotation * *joint.orientation;
    }
    return frame;
  };
  std::vector<SkeletonFrame> frames;
  for (int i = 0; i < 9; ++i) {
    const Quat rotation(Eigen::AngleAxisd(0.1 * i, Vec3::UnitY()));
    SkeletonFrame frame = moved(walk.front(), rotation, Vec3(0.2 * i, 0.0, 0.0));
    frame.time = i / 30.0;
    frames.push_back(frame);
  }
  const std::vector<SkeletalMotion> standing = {perform(character_.skeleton, frames).value()};
  Result<ChosenKeyframes> chosen = chooseKeyframes(character_, standing, 5, 1e-3);
  ASSERT_TRUE(chosen.ok());
  EXPECT_EQ(chosen->sources.size(), 1u);
  EXPECT_LT(chosen->farthest, 1e-3);

  SkeletonFrame step = walk[10];
  step.time = 9 / 30.0;
  frames.push_back(step);
  const std::vector<SkeletalMotion> stepping = {perform(character_.skeleton, frames).value()};
  chosen = chooseKeyframes(character_, stepping, 5, 1e-3);
  ASSERT_TRUE(chosen.ok());
  ASSERT_EQ(chosen->sources.size(), 2u);
  EXPECT_EQ(chosen->sources[1].frame, 9u);
}

TEST_F(Keyframes, NothingToChooseFromIsRefused) {
  EXPECT_FALSE(chooseKeyframes(character_, {}, 5, 0.0).ok());
  EXPECT_FALSE(chooseKeyframes(character_, motions_, 0, 0.0).ok());
  const std::vector<SkeletalMotion> empty(2, SkeletalMotion{"", character_.skeleton, {}, {}});
  EXPECT_FALSE(chooseKeyframes(character_, empty, 5, 0.0).ok());
}

class CoverPosesOf : public testing::Test {
 protected:
  Character character_ = makeMannequin();
  std::size_t jointCount_ = static_cast<std::size_t>(character_.skeleton.jointCount());
  std::vector<std::vector<SkeletonFrame>> recordings_ = {firstFrames("walk", 17), firstFrames("punch_and_kick", 30)};

  [[nodiscard]] std::vector<SkeletalMotion> motions() const { return performEach(character_, recordings_); }

  /// worldFromModel of every frame in sessions of the recordings.
  std::vector<std::vector<Affine3>> framesOfSessions() {
    const PoseView bindPose{character_.mesh.vertices, static_cast<int>(character_.mesh.vertices.size())};
    const Decomposition whole = test::valueOf(decompose(character_.mesh, bindPose, {.maxParts = 1}));
    std::vector<std::vector<Affine3>> all;
    for (const std::vector<SkeletonFrame>& recording : recordings_) {
      Session session = test::valueOf(Session::create(
          character_, whole, makeJointPoseSource(character_.skeleton, makeRecordedSource(recording)).value(), World()));
      while (*session.step()) {
        std::vector<Affine3>& frame = all.emplace_back(jointCount_);
        for (std::size_t j = 0; j < jointCount_; ++j) {
          frame[j] = session.worldFromJoint()[j] * character_.jointFromModel[j];
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
  recordings_ = {firstFrames("wave", 3)};
  const CoverPoses poses = test::valueOf(coverPoses(character_, motions(), 20));
  EXPECT_EQ(poses.sampledView().poseCount(), 2 + 10);
  EXPECT_EQ(poses.heldOutView().poseCount(), 1 + 10);
  recordings_ = {firstFrames("wave", 1)};
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

  EXPECT_TRUE(test::has(test::errorOf(coverPoses(character_, {}, 20)).message, "no motions"));
}

TEST_F(CoverPosesOf, ACharacterWithoutHumanBonesHasThePosesOfItsMotionsAlone) {
  Joint root;
  root.name = "root";
  character_.skeleton = *Skeleton::create({root});
  EXPECT_EQ(test::errorOf(coverPoses(character_, {}, 20)).code, ErrorCode::kInvalidArgument);
  const std::vector<SkeletalMotion> rest = {{"rest", character_.skeleton, {0.0}, restPose(character_.skeleton)}};
  character_.jointFromModel = {Affine3::Identity()};
  const CoverPoses one = test::valueOf(coverPoses(character_, rest, 20));
  EXPECT_EQ(one.randomPoses, 0);
  EXPECT_EQ(one.sampledView().poseCount(), 1);
  EXPECT_EQ(one.heldOutView().poseCount(), 0);
}

Motion recorded(std::string_view which) {
  Motion motion;
  motion.name = which;
  motion.joints = shippedFrames(which);
  return motion;
}

/// A clip in which nothing moves.
Clip stillClip() {
  Clip clip{"Stand", 1.0, {}};
  KeyTrack<Quat> still{KeyInterpolation::kLinear, {0.0, 1.0}, {Quat::Identity(), Quat::Identity()}};
  clip.tracks.push_back({0, std::nullopt, still, std::nullopt});
  return clip;
}

std::vector<std::string> namesOf(const Training& training) {
  std::vector<std::string> names;
  for (const SkeletalMotion& motion : training.motions) names.push_back(motion.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(Training, IsOnTheMotionsThatAreGiven) {
  const Character character = makeMannequin();
  const std::vector<Motion> given = {recorded("wave")};
  const std::vector<Clip> clips = {stillClip()};
  const Training training = test::valueOf(trainingMotions(character, given, clips));
  EXPECT_EQ(namesOf(training), Names{"wave"});
  EXPECT_FALSE(training.ownClips);
}

TEST(Training, OfACharacterWithClipsIsOnThemAndOnTheUsualMotions) {
  const Character character = makeMannequin();
  const std::vector<Clip> clips = {stillClip()};
  const Training training = test::valueOf(trainingMotions(character, {}, clips));
  Names expected{"Stand"};
  expected.insert(expected.end(), std::begin(kShippedMotions), std::end(kShippedMotions));
  EXPECT_EQ(namesOf(training), expected);
  EXPECT_TRUE(training.ownClips);
}

TEST(Training, OfWhatIsNoHumanoidAndHasNoClipsIsItsRestPose) {
  Character character = makeMannequin();
  std::vector<Joint> joints(character.skeleton.joints().begin(), character.skeleton.joints().end());
  for (Joint& joint : joints) joint.bone.reset();
  character.skeleton = *Skeleton::create(std::move(joints));
  const Training training = test::valueOf(trainingMotions(character, {}, {}));
  EXPECT_EQ(namesOf(training), Names{"rest pose"});
}

TEST(Training, LooksAtLongClipsLessOften) {
  const Character character = makeMannequin();
  std::vector<Clip> clips(2, stillClip());
  for (Clip& clip : clips) clip.seconds = kMaxTrainingPoses / kClipRate / character.skeleton.jointCount();
  const Training training = trainingMotions(character, {}, clips).value();
  double poses = 0.0;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    poses += static_cast<double>(training.motions[i].times.size() - 1) * character.skeleton.jointCount();
  }
  EXPECT_LE(poses, kMaxTrainingPoses + clips.size() * character.skeleton.jointCount());  // whole frames
  EXPECT_GE(poses, 0.99 * kMaxTrainingPoses);
}

/// The length of a clip costs a file nothing, so it is checked before the clip is sampled.
TEST(Motion, AClipOfMorePosesThanTheBudgetIsRefused) {
  const Skeleton skeleton = makeMannequin().skeleton;
  const double longest = kMaxClipPoses / kClipRate / skeleton.jointCount();
  Clip clip = stillClip();
  clip.seconds = 1.001 * longest;
  EXPECT_TRUE(test::has(test::errorOf(framesOf(skeleton, clip)).message, "the clip 'Stand' lasts"));
  clip.seconds = longest;
  const SkeletalMotion taken = test::valueOf(framesOf(skeleton, clip));
  EXPECT_LE(static_cast<double>(taken.times.size() - 1) * skeleton.jointCount(), kMaxClipPoses);
}

}  // namespace
}  // namespace lorica
