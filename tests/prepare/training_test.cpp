#include "prepare/training.h"

#include "capture/synthetic/synthetic_motion.h"
#include "geometry/work_budgets.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

Motion recorded(SyntheticMotion which) {
  Motion motion;
  motion.name = nameOf(which);
  motion.joints = synthesizeMotion(which);
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
const auto kUsual = [] { return Result<std::vector<Motion>>(std::vector<Motion>{recorded(SyntheticMotion::kWalk)}); };
const auto kNotFound = [] { return Result<std::vector<Motion>>(Error{ErrorCode::kNotFound, "no recordings"}); };

TEST(Training, IsOnTheMotionsThatAreGiven) {
  const Character character = makeMannequin();
  const std::vector<Motion> given = {recorded(SyntheticMotion::kWave)};
  const std::vector<Clip> clips = {stillClip()};
  const Training training = test::valueOf(trainingMotions(character, given, clips, kNotFound));
  EXPECT_EQ(namesOf(training), Names{"wave"});
  EXPECT_FALSE(training.ownClips);
}

TEST(Training, OfACharacterWithClipsIsOnThemAndOnTheUsualMotions) {
  const Character character = makeMannequin();
  const std::vector<Clip> clips = {stillClip()};
  const Training training = test::valueOf(trainingMotions(character, {}, clips, kUsual));
  EXPECT_EQ(namesOf(training), (Names{"Stand", "walk"}));
  EXPECT_TRUE(training.ownClips);
}

TEST(Training, NeedsTheUsualMotionsOnlyWhereThereAreNoClips) {
  const Character character = makeMannequin();
  const std::vector<Clip> clips = {stillClip()};
  const Training withClips = test::valueOf(trainingMotions(character, {}, clips, kNotFound));
  EXPECT_EQ(namesOf(withClips), Names{"Stand"});
  const Result<Training> without = trainingMotions(character, {}, {}, kNotFound);
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().message, "no recordings");
}

TEST(Training, OfWhatIsNoHumanoidAndHasNoClipsIsItsRestPose) {
  Character character = makeMannequin();
  std::vector<Joint> joints(character.skeleton.joints().begin(), character.skeleton.joints().end());
  for (Joint& joint : joints) joint.bone.reset();
  character.skeleton = *Skeleton::create(std::move(joints));
  const Training training = test::valueOf(trainingMotions(character, {}, {}, kNotFound));
  EXPECT_EQ(namesOf(training), Names{"rest pose"});
}

TEST(Training, LooksAtLongClipsLessOften) {
  const Character character = makeMannequin();
  std::vector<Clip> clips(2, stillClip());
  for (Clip& clip : clips) clip.seconds = kMaxTrainingPoses / kClipRate / character.skeleton.jointCount();
  const Training training = trainingMotions(character, {}, clips, kUsual).value();
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
  const Result<SkeletalMotion> refused = framesOf(skeleton, clip);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("the clip 'Stand' lasts"), std::string::npos) << refused.error().message;
  clip.seconds = longest;
  const SkeletalMotion taken = test::valueOf(framesOf(skeleton, clip));
  EXPECT_LE(static_cast<double>(taken.times.size() - 1) * skeleton.jointCount(), kMaxClipPoses);
}

}  // namespace
}  // namespace lorica
