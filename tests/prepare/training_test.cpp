#include "prepare/training.h"

#include "capture/synthetic/synthetic_motion.h"
#include "skinning/mannequin/mannequin.h"

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
  const Result<Training> training = trainingMotions(character, given, clips, kNotFound);
  ASSERT_TRUE(training) << training.error().message;
  EXPECT_EQ(namesOf(*training), Names{"wave"});
  EXPECT_FALSE(training->ownClips);
}

TEST(Training, OfACharacterWithClipsIsOnThemAndOnTheUsualMotions) {
  const Character character = makeMannequin();
  const std::vector<Clip> clips = {stillClip()};
  const Result<Training> training = trainingMotions(character, {}, clips, kUsual);
  ASSERT_TRUE(training) << training.error().message;
  EXPECT_EQ(namesOf(*training), (Names{"Stand", "walk"}));
  EXPECT_TRUE(training->ownClips);
}

TEST(Training, NeedsTheUsualMotionsOnlyWhereThereAreNoClips) {
  const Character character = makeMannequin();
  const std::vector<Clip> clips = {stillClip()};
  const Result<Training> withClips = trainingMotions(character, {}, clips, kNotFound);
  ASSERT_TRUE(withClips) << withClips.error().message;
  EXPECT_EQ(namesOf(*withClips), Names{"Stand"});
  const Result<Training> without = trainingMotions(character, {}, {}, kNotFound);
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().message, "no recordings");
}

TEST(Training, OfWhatIsNoHumanoidAndHasNoClipsIsItsRestPose) {
  Character character = makeMannequin();
  std::vector<Joint> joints(character.skeleton.joints().begin(), character.skeleton.joints().end());
  for (Joint& joint : joints) joint.bone.reset();
  character.skeleton = *Skeleton::create(std::move(joints));
  const Result<Training> training = trainingMotions(character, {}, {}, kNotFound);
  ASSERT_TRUE(training) << training.error().message;
  EXPECT_EQ(namesOf(*training), Names{"rest pose"});
}

}  // namespace
}  // namespace lorica
